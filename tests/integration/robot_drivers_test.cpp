// SPDX-License-Identifier: LGPL-3.0-or-later
/// The drivers of a Hokuyo scanner and of a Create 2 on pseudo-terminals, with the simulated
/// devices at the other ends.
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include <mauve/serial/serial_port.h>

#include "../../plugins/drivers/base/create_oi.h"
#include "../../plugins/drivers/laser/scip_write.h"

#include "../../plugins/types/motion.h"
#include "../../plugins/types/pose.h"
#include "../../plugins/types/scan.h"
#include "robot_drivers.h"
#include "support/temp_dir.h"

namespace {

using namespace robot;  // NOLINT: the architecture
using mauve::test::TempDir;

/// Everything, driving at 0.4 m/s towards a disc whose surface is 3.5 m ahead.
std::unique_ptr<System> everything() {
  return std::make_unique<System>(std::string(kSimulators) + kPilot + kLaser + "," + kBase,
                                  "pty:laser", "pty:base");
}

TEST(RobotDrivers, CarryScansAndOdometryOverSerialLines) {
  const auto robot = everything();
  ASSERT_TRUE(robot->deployed());
  EXPECT_TRUE(robot->reaches("world", "x", 0.5));

  const auto scan = robot->read<rover::LaserScan>("scan");
  const auto odometry = robot->read<rover::Odometry>("odometry");
  const auto twist = robot->read<rover::Twist>("twist");
  ASSERT_EQ(scan.ranges.size(), 541U);
  EXPECT_NEAR(scan.ranges[270], 3.5 - robot->observe("world", "x"), 0.1);
  EXPECT_NEAR(scan.angle(270), 0.0, 1e-4);
  EXPECT_GE(scan.ranges[0], scan.range_max) << "nothing in sight";
  EXPECT_NEAR(odometry.x, robot->observe("world", "x"), 0.1);
  EXPECT_NEAR(odometry.linear, 0.4, 0.03);
  EXPECT_NEAR(twist.linear, 0.4, 0.03);
  EXPECT_GT(twist.time, 0.0);
  EXPECT_EQ(robot->observe("base", "mode"), 2.0);
  EXPECT_EQ(robot->observe("laser", "bad_frames"), 0.0);
  EXPECT_EQ(robot->observe("base", "bad_frames"), 0.0);
  EXPECT_EQ(robot->observe("laser", "empty_scans"), 0.0);
  EXPECT_EQ(robot->observe("brake", "stops"), 0.0);
}

// A world that stands while the machine does is where no estimate expects it.
TEST(RobotDrivers, ASimulatedBaseDrivesOnWhileItsJobsAreLate) {
  std::string late = kSimulators;
  late.replace(late.find("15ms"), 4, "150ms");  // as if nine of ten jobs were missed
  System robot(late + kPilot + kLaser + "," + kBase, "pty:laser", "pty:base");
  ASSERT_TRUE(robot.deployed());
  ASSERT_TRUE(robot.reaches("world", "x", 0.1));
  const double before = robot.observe("world", "x");

  int steps = 0;
  ASSERT_TRUE(robot.run_until([&] { return ++steps == 200; }));

  EXPECT_NEAR(robot.observe("world", "x") - before, 0.4 * 2.0, 0.1);
  EXPECT_NEAR(robot.read<rover::Odometry>("odometry").x, robot.observe("world", "x"), 0.15);
}

TEST(RobotDrivers, StopBeforeTheObstacleThatOnlyTheScannerSees) {
  const auto robot = everything();
  ASSERT_TRUE(robot->deployed());
  ASSERT_TRUE(robot->reaches("world", "x", 1.0));
  ASSERT_EQ(robot->observe("pilot", "zone"), 0.0);

  EXPECT_TRUE(robot->run_until([&] { return robot->observe("pilot", "zone") == 2.0; }));
  EXPECT_TRUE(robot->run_until([&] { return robot->observe("wheels", "left") == 0.0; }));

  EXPECT_GT(robot->observe("world", "nearest"), 0.0);
  EXPECT_GT(robot->observe("world", "x"), 2.5);
}

TEST(RobotDrivers, AScannerThatGoesAndComesBackIsReadAgain) {
  const auto robot = everything();
  ASSERT_TRUE(robot->deployed());
  ASSERT_TRUE(robot->reaches("laser", "scans", 10));

  robot->set("scanner.core.turns", Value(std::int64_t{600}));  // makes another line

  EXPECT_TRUE(robot->reaches("laser", "reopened", 1));
  EXPECT_TRUE(robot->goes_on("laser", "scans", 10));
  EXPECT_GE(robot->observe("laser", "device_errors"), 1.0);
}

TEST(RobotDrivers, AScannerThatFallsSilentIsAskedAgainAndTheRobotStands) {
  const auto robot = everything();
  ASSERT_TRUE(robot->deployed());
  ASSERT_TRUE(robot->reaches("world", "x", 0.1));

  ASSERT_TRUE(robot->deployer().stop({"scanner"}));
  EXPECT_TRUE(robot->goes_on("laser", "timeouts", 2));
  EXPECT_EQ(robot->observe("wheels", "left"), 0.0);
  EXPECT_EQ(robot->observe("pilot", "zone"), 2.0);

  ASSERT_TRUE(robot->deployer().start({"scanner"}));
  EXPECT_TRUE(robot->goes_on("laser", "scans", 10));
  EXPECT_TRUE(robot->goes_on("world", "x", 0.1));
}

TEST(RobotDrivers, ACoveredScannerStopsTheRobot) {
  const auto robot = everything();
  ASSERT_TRUE(robot->deployed());
  ASSERT_TRUE(robot->reaches("world", "x", 0.1));

  robot->set("scanner.core.covered", Value(true));

  EXPECT_TRUE(robot->reaches("laser", "empty_scans", 3));
  EXPECT_TRUE(robot->run_until([&] { return robot->observe("pilot", "zone") == 2.0; }));
  EXPECT_TRUE(robot->run_until([&] { return robot->observe("wheels", "left") == 0.0; }));
  EXPECT_GT(robot->observe("pilot", "blind_scans"), 0.0);
  EXPECT_EQ(robot->observe("laser", "empty"), 1.0);
  EXPECT_EQ(robot->read<rover::LaserScan>("scan").ranges[270], 0.0F) << "published all the same";
}

TEST(RobotDrivers, TheBrakeStopsABaseWhoseDriverIsStopped) {
  const auto robot = everything();
  ASSERT_TRUE(robot->deployed());
  ASSERT_TRUE(robot->reaches("world", "x", 0.1));
  // It stands for a while when its driver heard nothing for too long and began anew.
  ASSERT_TRUE(robot->run_until([&] { return robot->observe("wheels", "left") > 0.0; }));

  ASSERT_TRUE(robot->deployer().stop({"base"}));

  EXPECT_TRUE(robot->run_until([&] { return robot->observe("wheels", "left") == 0.0; }));
  EXPECT_EQ(robot->observe("brake", "stops"), 1.0);
  int more = 100;
  ASSERT_TRUE(robot->run_until([&] { return --more == 0; }));
  EXPECT_EQ(robot->observe("wheels", "left"), 0.0) << "no command of the driver came behind it";
  ASSERT_TRUE(robot->deployer().start({"base"}));
  EXPECT_TRUE(robot->goes_on("world", "x", 0.1)) << "armed again";
}

TEST(RobotDrivers, ASwapDoesNotStopTheBase) {
  const auto robot = everything();
  ASSERT_TRUE(robot->deployed());
  ASSERT_TRUE(robot->reaches("world", "x", 0.1));
  const double commands = robot->observe("wheels", "commands");

  robot->set("base.core.speed_max", Value(0.4));
  robot->set("laser.core.scans_per_job", Value(std::int64_t{4}));
  bool stood = false;
  ASSERT_TRUE(robot->run_until([&] {
    stood = stood || robot->observe("wheels", "left") == 0.0;
    return robot->observe("wheels", "commands") > commands + 50;
  }));

  EXPECT_FALSE(stood);
  EXPECT_EQ(robot->observe("base", "jumps"), 0.0);
  EXPECT_EQ(robot->observe("laser", "device_errors"), 0.0);
}

/// A scanner that grants all requests but the one to switch its beam on.
class RefusingScanner {
 public:
  RefusingScanner() { EXPECT_TRUE(line.open("")); }
  void answer() {
    std::array<char, 256> bytes{};
    heard_.append(bytes.data(), line.receive(bytes));
    for (auto end = heard_.find('\n'); end != std::string::npos; end = heard_.find('\n')) {
      const std::string request = heard_.substr(0, end);
      heard_.erase(0, end + 1);
      static_cast<void>(line.send(reply_to(request)));
    }
  }

  mauve::serial::PseudoTerminal line;
  bool refuses = true;

 private:
  std::string_view reply_to(const std::string& request) {
    constexpr drivers::scip::Limits kUrg{20, 5600, 1024, 44, 725, 384, 600};
    if (request == "PP") return writer_.limits(request, kUrg);
    if (request == "BM" && refuses) return writer_.reply(request, "01");
    return writer_.reply(request, "00");
  }

  drivers::scip::ReplyWriter writer_;
  std::string heard_;
};

TEST(RobotDrivers, AScannerThatRefusesToMeasureOrSendsNoScanIsNamed) {
  RefusingScanner scanner;
  System robot(kLaser, scanner.line.device(), "pty:base");
  ASSERT_TRUE(robot.deployed());
  robot.meanwhile([&] { scanner.answer(); });
  const auto is_silent = [&] { return robot.observe("laser", "silent") == 1.0; };

  EXPECT_TRUE(robot.reaches("laser", "refused", 3));
  EXPECT_TRUE(robot.run_until(is_silent));
  EXPECT_EQ(robot.reason("laser", "silent"), "its scanner refuses to measure: status 1");

  scanner.refuses = false;
  EXPECT_TRUE(robot.goes_on("laser", "timeouts", 2)) << "it grants, and sends nothing";
  EXPECT_TRUE(is_silent());
  EXPECT_EQ(robot.reason("laser", "silent"), "its scanner answers, and sends no undamaged scan");
}

/// Its button was pressed, it stands on its dock, or its mode is not known.
TEST(RobotDrivers, ABaseThatObeysNoCommandIsNamedAndItsWheelsAreCounted) {
  mauve::serial::PseudoTerminal line;
  ASSERT_TRUE(line.open(""));
  System robot(kBase, "pty:laser", line.device());
  ASSERT_TRUE(robot.deployed());
  std::uint16_t count = 0;
  int mode = 2;
  robot.meanwhile([&] {
    count = static_cast<std::uint16_t>(count + 20);
    const auto frame =
        drivers::create::frame_of({0, static_cast<drivers::create::Mode>(mode), count, count});
    static_cast<void>(line.send({frame.data(), frame.size()}));
  });
  ASSERT_TRUE(robot.reaches("base", "frames", 100));
  EXPECT_EQ(robot.observe("base", "disobeys"), 0.0);

  for (const int other : {1, 4, 0}) {
    mode = other;
    EXPECT_TRUE(robot.run_until([&] { return robot.observe("base", "disobeys") == 1.0; })) << other;
    const double way = robot.read<rover::Odometry>("odometry").x;
    EXPECT_TRUE(robot.goes_on("base", "frames", 100));
    EXPECT_GT(robot.read<rover::Odometry>("odometry").x, way + 0.3) << other;
    mode = 2;
    EXPECT_TRUE(robot.run_until([&] { return robot.observe("base", "disobeys") == 0.0; })) << other;
  }
  EXPECT_EQ(robot.observe("base", "bad_frames"), 0.0);
  EXPECT_EQ(robot.observe("base", "timeouts"), 0.0);
}

TEST(RobotDrivers, RefuseADeviceIntoWhichTheyMustNotWrite) {
  TempDir place;
  const std::string precious = place.write("recording", "precious").string();
  const System laser(kLaser, precious, "pty:base");
  const System base(kBase, "pty:laser", precious);

  for (const System* system : {&laser, &base}) {
    ASSERT_FALSE(system->deployed());
    EXPECT_NE(to_string(system->deployed().error()).find("is no serial device"), std::string::npos);
  }
  EXPECT_EQ(TempDir::read(precious), "precious");
}

}  // namespace
