// SPDX-License-Identifier: LGPL-3.0-or-later
/// The inertial unit's driver on a simulated clock, and simulated devices that speak to the real
/// drivers.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <mauve/serial/serial_port.h>

#include "../../plugins/drivers/imu/xbus_frame.h"
#include "../../plugins/drivers/imu/xbus_imu.h"
#include "serial_drivers.h"
#include "support/temp_dir.h"

namespace {

using namespace serial;  // NOLINT: the driver
using mauve::test::TempDir;
using rover::Imu;

std::string imu(const std::string& device) { return driver("drivers/imu", "imu/1", "imu", device); }

std::string xbus(const Imu& imu, std::uint32_t ticks) {
  drivers::ImuWriter writer;
  const auto frame = writer.compose(imu, ticks);
  return {frame.begin(), frame.end()};
}

TEST(ImuDriver, PublishesEachMeasurementInGarbageAndWithoutItsDevice) {
  const TempDir place;
  const std::string device = (place / "imu").string();
  Simulated driver(imu(device));
  ASSERT_TRUE(driver.up());
  driver.run(300ms);
  EXPECT_EQ(driver.state(), "wait_device");
  PseudoTerminal line;
  ASSERT_TRUE(line.open(device));
  ASSERT_TRUE(driver.reaches("reopened", 1));

  for (unsigned i = 0; i < 100; ++i) {
    driver.take(line, "garbage\xfa" + xbus({0.0, 0.01 * i, 0.0, 0.0, 0.5, true}, 100 * i));
    driver.run(10ms);
  }
  driver.run(100ms);

  EXPECT_EQ(driver.observe("measurements"), 100);
  EXPECT_EQ(driver.observe("reopened"), 1);
  EXPECT_EQ(driver.observe("bad_frames"), 0);
  EXPECT_NEAR(driver.data<Imu>().yaw_rate, 0.99, 1e-6);
  EXPECT_NEAR(driver.data<Imu>().heading, 0.5, 1e-6);
}

TEST(ImuDriver, UsesTheNextGoodFrameAfterTheLineOverflowed) {
  PseudoTerminal line;
  ASSERT_TRUE(line.open(""));
  Simulated driver(imu(line.device()));
  ASSERT_TRUE(driver.up());
  driver.run(1ms);

  // No job runs: the line's thread and the kernel take what they have room for, the rest is lost.
  std::size_t lost = 0;
  std::uint32_t ticks = 0;
  ASSERT_TRUE(mauve::test::eventually([&] {
    lost += line.send(xbus({}, ++ticks)) ? 0 : 1;
    return lost == 20;
  }));
  ASSERT_TRUE(driver.reaches("measurements", static_cast<std::int64_t>(ticks - lost) - 1))
      << "one is cut at most";
  const std::int64_t before = driver.observe("measurements");
  for (unsigned i = 1; i <= 10; ++i) {
    driver.take(line, xbus({}, ++ticks));
    driver.run(50ms);
  }

  EXPECT_GE(driver.observe("measurements"), before + 9) << "one may end what was cut";
  EXPECT_LE(driver.observe("bad_frames"), static_cast<std::int64_t>(lost));
}

TEST(ImuDriver, CountsDamageAndValuesThatAreNoNumbers) {
  PseudoTerminal line;
  ASSERT_TRUE(line.open(""));
  Simulated driver(imu(line.device()));
  ASSERT_TRUE(driver.up());
  std::string damaged = xbus({}, 1);
  damaged[20] = static_cast<char>(damaged[20] ^ 0x10);

  driver.run(1ms);
  driver.take(line, damaged + xbus({0.0, NAN, 0.0, 0.0, 0.0, false}, 2));
  driver.take(line, xbus({}, 3) + xbus({}, 4).substr(0, 20));
  driver.run(500ms);
  EXPECT_EQ(driver.observe("bad_frames"), 1);
  EXPECT_EQ(driver.observe("implausible"), 1);
  EXPECT_EQ(driver.observe("measurements"), 1);
  driver.run(6s);

  EXPECT_EQ(driver.observe("bad_frames"), 2) << "the half frame";
}

/// The bytes of a message of a unit, with these items.
std::string message(const std::string& items) {
  std::vector<std::uint8_t> frame(drivers::XbusFormat::kHeader, 0);
  frame.insert(frame.end(), items.begin(), items.end());
  frame.push_back(0);
  drivers::xbus_seal(frame, 0x36);
  return {frame.begin(), frame.end()};
}

/// It works as it is asked, and there is nothing that it could publish.
TEST(ImuDriver, NamesWhatKeepsItFromPublishing) {
  using namespace std::string_literals;
  PseudoTerminal line;
  ASSERT_TRUE(line.open(""));
  Simulated driver(imu(line.device()));
  ASSERT_TRUE(driver.up());
  const auto after_5s_of = [&](const std::string& bytes) {
    for (int i = 0; i < 52; ++i) {
      driver.take(line, bytes);
      driver.run(100ms);
    }
    return driver.warning("silent");
  };
  const std::string double_rate = "\x80\x23\x18"s + std::string(24, '\0');
  const std::string status = "\xe0\x20\x04\0\0\0\x02"s;

  driver.run(4900ms);
  EXPECT_EQ(driver.warning("silent"), "") << "not yet";
  driver.run(200ms);
  EXPECT_EQ(driver.warning("silent"), "its device sends nothing");
  driver.take(line, xbus({}, 1));
  driver.run(20ms);
  EXPECT_EQ(driver.warning("silent"), "") << "it publishes";

  EXPECT_EQ(after_5s_of("\x33garbage"),
            "its device sends bytes, and no undamaged frame: look at `baud`");
  EXPECT_EQ(after_5s_of(message(double_rate)),
            "its unit sends no rate of turn (item 0x8020 of MTData2)");
  EXPECT_EQ(after_5s_of(message(status)),
            "its unit sends no rate of turn (item 0x8020 of MTData2)");
  EXPECT_EQ(after_5s_of(message("\x80\x20\x18"s + std::string(24, '\0'))),
            "its items are no vectors of single precision");
  EXPECT_EQ(after_5s_of(xbus({0.0, NAN, 0.0, 0.0, 0.0, false}, 2)),
            "its values are no numbers, or beyond the range of any unit");

  driver.take(line, xbus({}, 3));
  driver.run(20ms);
  EXPECT_EQ(driver.observe("silent"), 0);
}

/// The simulated world at the far end: a receiver and a unit that speak to the real drivers.
std::string world(const std::string& protocol) {
  return R"({"schema": "mauve/architecture/1", "name": "line", "plugins": ["types", "drivers"],
    "resources": {"world": {"type": "drivers/world",
                            "properties": {"core.imu_heading_noise": 0.01}},
                  "fix": {"type": "shared_data", "data": "gnss_fix/1"},
                  "data": {"type": "shared_data", "data": "imu/1"}},
    "components": {
      "gnss": {"type": "drivers/gnss", "properties": {"core.device": "pty:gnss"},
               "ports": {"fix": "fix.write"}},
      "driver": {"type": "drivers/imu", "properties": {"core.device": "pty:imu"},
                 "ports": {"imu": "data.write"}},
      "receiver": {"type": "drivers/receiver_sim", "ports": {"antenna": "world.antenna"},
                   "properties": {"fsm.period": "100ms", "core.protocol": ")" +
         protocol + R"("}},
      "unit": {"type": "drivers/imu_sim", "ports": {"world": "world.imu"}}}})";
}

TEST(SimulatedDevices, SpeakToTheRealDriversListedBeforeThem) {
  for (const char* protocol : {"nmea", "ubx"}) {
    SCOPED_TRACE(protocol);
    Simulated line(world(protocol));
    ASSERT_TRUE(line.up());

    EXPECT_TRUE(line.reaches("fixes", 4, "gnss"));
    EXPECT_TRUE(line.reaches("measurements", 450));
    EXPECT_EQ(line.observe("bad_frames", "gnss"), 0);
    EXPECT_EQ(line.observe("satellites", "gnss"), 9);
    EXPECT_EQ(line.observe("bad_frames"), 0);
    EXPECT_TRUE(line.data<Imu>().has_heading);
    EXPECT_LT(std::abs(line.data<Imu>().yaw_rate), 0.1);
  }
}

TEST(SimulatedDevices, RefuseAProtocolThatDoesNotExist) {
  Simulated line(world("morse"));

  ASSERT_FALSE(line.up());
  EXPECT_NE(line.up().error().message.find("nmea or ubx"), std::string::npos);
}

}  // namespace
