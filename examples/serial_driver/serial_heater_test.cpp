// SPDX-License-Identifier: LGPL-3.0-or-later
/// The driver with a simulated device on a pseudo-terminal.
#include <gtest/gtest.h>
#include <mauve/serial/serial_port.h>
#include <mauve/test_kit.h>

#include <functional>
#include <thread>

#include "serial_heater.h"

namespace {

using namespace std::chrono_literals;
using serial_heater::Driver;

constexpr mauve::Duration kPeriod = 10ms;

/// The component on a simulated clock, and its device.
struct Bench : mauve::ComponentBench<serial_heater::Shell, Driver, mauve::PeriodicFsm<Driver>> {
  Bench() {
    EXPECT_TRUE(device.open(""));
    core().line.device = device.device();
  }

  /// Runs jobs until the condition holds: the thread of the line needs some time.
  bool run_until(const std::function<bool()>& condition) {
    for (int i = 0; i < 10'000; ++i) {
      run_for(kPeriod);
      if (condition()) return true;
      std::this_thread::sleep_for(1ms);
    }
    return false;
  }
  std::optional<double> temperature() { return ports().written(shell().temperature); }
  /// All commands that the device has heard so far.
  const std::string& heard() {
    std::array<char, 256> some{};
    while (const std::size_t size = device.receive(some)) all.append(some.data(), size);
    return all;
  }

  mauve::serial::PseudoTerminal device;
  std::string all;
};

TEST(Driver, WritesWhatTheDeviceSends) {
  Bench bench;
  ASSERT_TRUE(bench.deploy());
  bench.device.send("21.5");
  bench.device.send("0\n22.25\n");
  EXPECT_TRUE(bench.run_until([&] { return bench.temperature() == 22.25; }));
}

TEST(Driver, CountsADamagedLineAndContinues) {
  Bench bench;
  ASSERT_TRUE(bench.deploy());
  bench.device.send("2x.50\n-3.5\n");
  EXPECT_TRUE(bench.run_until([&] { return bench.temperature() == -3.5; }));
  EXPECT_EQ(bench.core().damaged, 1);
}

TEST(Driver, SendsThePowerInSteps) {
  Bench bench;
  ASSERT_TRUE(bench.deploy());
  bench.ports().give(bench.shell().power, 4.0);
  ASSERT_TRUE(bench.run_until([&] { return bench.heard().find("P4\n") != std::string::npos; }));
  EXPECT_EQ(bench.heard().find("P1\nP2\nP3\nP4\n"), 0U) << bench.heard();
}

TEST(Driver, HeatsNotWithoutACommandThatIsFreshAndANumber) {
  mauve::serial::PseudoTerminal device;
  ASSERT_TRUE(device.open(""));
  mauve::CoreBench<serial_heater::Shell, Driver> bench;
  bench.core().line.device = device.device();
  bench.max_age(bench.shell().power, 100ms);
  ASSERT_TRUE(bench.configure());
  const auto power_after = [&](mauve::Duration time) {
    bench.advance(time);
    bench.core().update();
    return bench.core().power.get();
  };
  EXPECT_EQ(power_after(kPeriod), 0.0) << "no command came";
  bench.give(bench.shell().power, 5.0);
  EXPECT_EQ(power_after(50ms), 5.0);
  EXPECT_EQ(power_after(100ms), 0.0) << "the command is too old";
  bench.give(bench.shell().power, std::nan(""));
  EXPECT_EQ(power_after(50ms), 0.0);
}

TEST(Driver, WaitsForADeviceThatIsNotThereYet) {
  const std::string link = testing::TempDir() + "serial_heater_late";
  Bench bench;
  bench.core().line.device = link;
  ASSERT_TRUE(bench.deploy());
  bench.run_for(kPeriod);
  EXPECT_FALSE(bench.core().online);

  mauve::serial::PseudoTerminal late;
  ASSERT_TRUE(late.open(link));
  late.send("21.50\n");

  EXPECT_TRUE(bench.run_until([&] { return bench.temperature() == 21.5; }));
  EXPECT_TRUE(bench.core().online);
}

TEST(Driver, RefusesADeviceThatIsNone) {
  Bench bench;
  bench.core().line.device = "/dev/null";
  EXPECT_FALSE(bench.deploy());
}

/// A reload lets both cores open the device at once: no byte is lost, no output jumps.
TEST(Driver, ContinuesEveryOutputOverASwapWithItself) {
  const auto prepare = [](Bench& bench) {
    ASSERT_TRUE(bench.deploy());
    bench.ports().give(bench.shell().power, 50.0);
  };
  // One job before the device sends, so that the new core reads; one when all of it has come.
  const auto step = [](Bench& bench, int number) {
    bench.run_for(kPeriod);
    const std::string text = number % 2 == 0 ? "2" : std::to_string(number) + ".5\n";
    const std::uint64_t before = bench.core().line.received;
    bench.device.send(text);
    for (int i = 0; bench.core().line.received < before + text.size() && i < 10'000; ++i) {
      std::this_thread::sleep_for(1ms);
    }
    bench.run_for(kPeriod);
  };
  EXPECT_EQ(mauve::difference_when_renewed<Bench>(20, prepare, step), "");
}

TEST(Driver, UsesNoHeapAndOneSystemCallInAJob) {
  Bench bench;
  ASSERT_TRUE(bench.deploy());
  bench.device.send("21.50\n");
  // Both threads of the line are at work then. Until they are, a job wakes them again.
  ASSERT_TRUE(
      bench.run_until([&] { return bench.temperature() == 21.5 && !bench.heard().empty(); }));
  bench.run_for(kPeriod);
  EXPECT_EQ(bench.cost().heap_calls.value_or(0), 0U);
  EXPECT_LE(bench.cost().system_calls.value_or(0), 1U) << "a send wakes the thread that writes";
}

}  // namespace
