// SPDX-License-Identifier: LGPL-3.0-or-later
/// The driver with a simulated device on a pseudo-terminal.
#include <gtest/gtest.h>
#include <mauve/test_kit.h>

#include <functional>

#include "pseudo_terminal.h"
#include "serial_thermometer.h"

namespace {

struct DriverTest : testing::Test {
  DriverTest() { bench.core().device = line.path(); }

  /// Runs jobs until the condition holds: the thread of the line needs some time.
  bool update_until(const std::function<bool()>& condition) {
    for (int i = 0; i < 10'000; ++i) {
      bench.core().update();
      if (condition()) return true;
      std::this_thread::sleep_for(1ms);
    }
    return false;
  }
  std::optional<double> written() { return bench.written(bench.shell().temperature); }

  PseudoTerminal line;
  mauve::CoreBench<serial_thermometer::Shell, serial_thermometer::Driver> bench;
};

TEST_F(DriverTest, WritesWhatTheDeviceSends) {
  ASSERT_TRUE(bench.configure());
  line.send("21.5");
  line.send("0\n22.25\n");
  EXPECT_TRUE(update_until([&] { return written() == 22.25; }));
}

TEST_F(DriverTest, CountsADamagedLineAndContinues) {
  ASSERT_TRUE(bench.configure());
  line.send("2x.50\n-3.5\n");
  EXPECT_TRUE(update_until([&] { return written() == -3.5; }));
  EXPECT_EQ(bench.core().damaged, 1);
}

TEST_F(DriverTest, RefusesADeviceThatIsNotThere) {
  bench.core().device = "/dev/no_such_line";
  EXPECT_FALSE(bench.configure());
}

TEST_F(DriverTest, RefusesALineThatAnotherDriverReads) {
  ASSERT_TRUE(bench.configure());
  serial_thermometer::Driver second;
  second.device = line.path();
  const mauve::Status refused = second.configure();
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message, "another driver has opened it");
}

TEST_F(DriverTest, MakesNoSystemCallInAJob) {
  ASSERT_TRUE(bench.configure());
  bench.core().update();
  EXPECT_EQ(bench.cost([&] { bench.core().update(); }).system_calls.value_or(0), 0U);
}

}  // namespace
