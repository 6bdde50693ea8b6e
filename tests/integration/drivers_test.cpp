// SPDX-License-Identifier: LGPL-3.0-or-later
/// The drivers of a Hokuyo scanner and of a Create 2 on pseudo-terminals, with the simulated
/// devices at the other ends, or the test itself; on a simulated clock.
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <mauve/architecture.h>
#include <mauve/deployer.h>
#include <mauve/job.h>

#include "../../plugins/drivers/create_oi.h"
#include "../../plugins/drivers/scip_write.h"
#include "../../plugins/drivers/serial_port.h"
#include "../../plugins/types/motion.h"
#include "../../plugins/types/pose.h"
#include "../../plugins/types/velocity.h"
#include "arch/load.h"
#include "plugin/catalog.h"
#include "support/eventually.h"
#include "support/temp_dir.h"

namespace {

using namespace std::chrono_literals;  // NOLINT: durations
using mauve::Value;
using mauve::test::TempDir;
namespace scip = drivers::scip;
namespace create = drivers::create;

constexpr const char* kHead = R"({ "schema": "mauve/architecture/1", "name": "drivers",
  "plugins": ["types", "drivers", "safety"],
  "resources": {
    "world": { "type": "drivers/world", "properties": { "core.laser_noise": 0.0,
      "core.speed_disturbance": 0.0, "core.turn_disturbance": 0.0,
      "core.obstacles": [ { "at": { "x": 4.0, "y": 0.0 }, "radius": 0.5 } ] } },
    "brake": { "type": "drivers/create_brake", "properties": { "core.device": "BASE" } },
    "scan": { "type": "shared_data", "data": "laser_scan/1" },
    "odometry": { "type": "shared_data", "data": "odometry/1" },
    "twist": { "type": "shared_data", "data": "twist/1" },
    "command": { "type": "shared_data", "data": "velocity/1" },
    "safe_command": { "type": "shared_data", "data": "velocity/1" } },
  "components": {)";
constexpr const char* kSimulators = R"(
    "scanner": { "type": "drivers/hokuyo_sim", "properties": { "fsm.period": "25ms" },
      "ports": { "world": "world.scan" } },
    "wheels": { "type": "drivers/create_sim", "properties": { "fsm.period": "15ms" },
      "ports": { "drive": "world.drive" } },)";
constexpr const char* kPilot = R"(
    "cruise": { "type": "safety/cruise", "properties": { "core.velocity": { "linear": 0.4, "angular": 0.0 } },
      "ports": { "command": "command.write" } },
    "pilot": { "type": "safety/pilot", "properties": { "core.stop_distance": 0.5, "core.slow_distance": 1.0 },
      "ports": { "command": "command.read", "scan": "scan.read", "safe_command": "safe_command.write" } },)";
constexpr const char* kLaser = R"(
    "laser": { "type": "drivers/hokuyo", "properties": { "core.device": "LASER" },
      "ports": { "scan": "scan.write" } })";
constexpr const char* kBase = R"(
    "base": { "type": "drivers/create", "properties": { "core.device": "BASE", "core.baud": 0 },
      "ports": { "command": "safe_command.read", "odometry": "odometry.write", "twist": "twist.write",
                 "brake": "brake.write" } })";

class System {
 public:
  System(const std::string& components, const std::string& laser, const std::string& base)
      : catalog_({MAUVE_PLUGIN_DIR}) {
    std::string text = kHead + components + "} }";
    replace(text, "LASER", laser);
    replace(text, "BASE", base);
    mauve::arch::Problems problems;
    architecture_ = mauve::arch::load(text, catalog_, problems);
    EXPECT_TRUE(architecture_ != nullptr)
        << (problems.empty() ? "" : to_string(problems.sorted()[0].error));
    if (architecture_ == nullptr) return;
    deployer_ = std::make_unique<mauve::Deployer>(
        *architecture_, mauve::DeployOptions{mauve::Realtime::off, true, mauve::Admission::warn});
    deployed_ = deployer_->deploy();
  }

  [[nodiscard]] const mauve::Status& deployed() const { return deployed_; }
  [[nodiscard]] mauve::Deployer& deployer() { return *deployer_; }

  [[nodiscard]] double observe(const std::string& owner, const std::string& name) const {
    const auto* component = architecture_->find_component(owner);
    const mauve::CoreBase& core =
        component != nullptr ? component->core() : architecture_->find_resource(owner)->core();
    const Value value = core.find_observable(name)->value();
    if (const auto* integer = value.get_if<std::int64_t>()) return static_cast<double>(*integer);
    if (const auto* truth = value.get_if<bool>()) return *truth ? 1.0 : 0.0;
    return *value.get_if<double>();
  }
  /// The value of a resource; its default when there is none.
  template <typename T>
  [[nodiscard]] T read(const std::string& resource) const {
    mauve::ServiceBase& service = *architecture_->find_resource(resource)->find_service("read");
    mauve::Cursor cursor{service.attach(), 0, 0};
    T value{};
    static_cast<void>(service.read(&value, cursor));
    service.detach(cursor.slot);
    return value;
  }
  /// Writes as a job that runs now.
  template <typename T>
  void write(const std::string& resource, const T& value) {
    const mauve::Instant before = mauve::this_job().start;
    mauve::this_job().start = deployer_->clock().now();
    architecture_->find_resource(resource)->find_service("write")->write(&value);
    mauve::this_job().start = before;
  }
  void set(const std::string& address, const Value& value) {
    const auto done = deployer_->set(address, value);
    EXPECT_TRUE(done) << (done ? "" : to_string(done.error()));
  }

  /// Lets time pass, 10 ms at a time, until it is so. The bytes need a moment of real time.
  [[nodiscard]] bool run_until(const std::function<bool()>& condition) {
    return mauve::test::eventually([&] {
      deployer_->run_for(10ms);
      if (meanwhile_) meanwhile_();
      return condition();
    });
  }
  /// What the test does every 10 ms.
  void meanwhile(std::function<void()> work) { meanwhile_ = std::move(work); }
  [[nodiscard]] bool reaches(const std::string& owner, const std::string& name, double least) {
    return run_until([=, this] { return observe(owner, name) >= least; });
  }
  [[nodiscard]] bool goes_on(const std::string& owner, const std::string& name, double by) {
    return reaches(owner, name, observe(owner, name) + by);
  }

 private:
  static void replace(std::string& text, const std::string& what, const std::string& by) {
    for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size()) {
      text.replace(at, what.size(), by);
    }
  }

  mauve::plugin::Catalog catalog_;
  std::unique_ptr<mauve::Architecture> architecture_;
  std::unique_ptr<mauve::Deployer> deployer_;
  mauve::Status deployed_ = mauve::ok();
  std::function<void()> meanwhile_;
};

/// Everything, driving at 0.4 m/s towards a disc whose surface is 3.5 m ahead.
std::unique_ptr<System> everything() {
  return std::make_unique<System>(std::string(kSimulators) + kPilot + kLaser + "," + kBase,
                                  "pty:laser", "pty:base");
}

TEST(Drivers, CarryScansAndOdometryOverSerialLines) {
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

TEST(Drivers, StopBeforeTheObstacleThatOnlyTheScannerSees) {
  const auto robot = everything();
  ASSERT_TRUE(robot->deployed());
  ASSERT_TRUE(robot->reaches("world", "x", 1.0));
  ASSERT_EQ(robot->observe("pilot", "zone"), 0.0);

  EXPECT_TRUE(robot->run_until([&] { return robot->observe("pilot", "zone") == 2.0; }));
  EXPECT_TRUE(robot->run_until([&] { return robot->observe("wheels", "left") == 0.0; }));

  EXPECT_GT(robot->observe("world", "nearest"), 0.0);
  EXPECT_GT(robot->observe("world", "x"), 2.5);
}

TEST(Drivers, AScannerThatGoesAndComesBackIsReadAgain) {
  const auto robot = everything();
  ASSERT_TRUE(robot->deployed());
  ASSERT_TRUE(robot->reaches("laser", "scans", 10));

  robot->set("scanner.core.turns", Value(std::int64_t{600}));  // makes another line

  EXPECT_TRUE(robot->reaches("laser", "reopened", 1));
  EXPECT_TRUE(robot->goes_on("laser", "scans", 10));
  EXPECT_GE(robot->observe("laser", "device_errors"), 1.0);
}

TEST(Drivers, AScannerThatFallsSilentIsAskedAgainAndTheRobotStands) {
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

TEST(Drivers, ACoveredScannerStopsTheRobot) {
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

TEST(Drivers, TheBrakeStopsABaseWhoseDriverIsStopped) {
  const auto robot = everything();
  ASSERT_TRUE(robot->deployed());
  ASSERT_TRUE(robot->reaches("world", "x", 0.1));
  ASSERT_GT(robot->observe("wheels", "left"), 0.0);

  ASSERT_TRUE(robot->deployer().stop({"base"}));

  EXPECT_TRUE(robot->run_until([&] { return robot->observe("wheels", "left") == 0.0; }));
  EXPECT_EQ(robot->observe("brake", "stops"), 1.0);
  ASSERT_TRUE(robot->deployer().start({"base"}));
  EXPECT_TRUE(robot->goes_on("world", "x", 0.1)) << "armed again";
}

TEST(Drivers, ASwapDoesNotStopTheBase) {
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

TEST(Drivers, RefuseToBeginWithoutTheirDevice) {
  const System laser(kLaser, "/nowhere/ttyACM7", "pty:base");
  const System base(kBase, "pty:laser", "/nowhere/ttyUSB7");

  ASSERT_FALSE(laser.deployed());
  EXPECT_NE(to_string(laser.deployed().error()).find("/nowhere/ttyACM7"), std::string::npos);
  ASSERT_FALSE(base.deployed());
  EXPECT_NE(to_string(base.deployed().error()).find("/nowhere/ttyUSB7"), std::string::npos);
}

/// A scanner of five beams that the test holds in its hands.
class HandScanner {
 public:
  explicit HandScanner(std::string path) : path_(std::move(path)) { plug(); }
  void plug() {
    EXPECT_TRUE(line_.open(path_));
    measuring_ = false;
  }
  void unplug() { line_.close(); }

  /// Answers, and sends a scan when it shall.
  void turn() {
    std::array<char, 256> bytes{};
    const std::size_t count = line_.receive(bytes);
    for (std::size_t i = 0; i < count; ++i) {
      if (heard_.push(bytes[i]) && !heard_.line().empty()) answer(std::string(heard_.line()));
    }
    if (!measuring_) return;
    line_.send(next_.empty() ? std::string(writer_.scan(request_, 0, values_)) : next_);
  }
  /// Sent in place of scans from now on; empty: scans.
  void say(std::string bytes) { next_ = std::move(bytes); }
  std::string a_scan() { return std::string(writer_.scan(request_, 0, values_)); }
  void refuse(bool refuses) { refuses_ = refuses; }

 private:
  void answer(const std::string& request) {
    if (refuses_) {
      line_.send(writer_.reply(request, "10"));
    } else if (request == "PP") {
      line_.send(writer_.limits(request, {20, 5000, 360, 178, 182, 180, 600}));
    } else {
      line_.send(writer_.reply(request, "00"));
      measuring_ = request[0] == 'M';
    }
    if (const auto wanted = scip::Request::parse(request)) request_ = *wanted;
  }

  std::string path_;
  drivers::PseudoTerminal line_;
  scip::LineReader heard_;
  scip::ReplyWriter writer_;
  scip::Request request_;
  std::array<std::uint32_t, 5> values_{1000, 1001, 1002, 0, 5000};
  std::string next_;
  bool measuring_ = false;
  bool refuses_ = false;
};

class LaserInHand : public testing::Test {
 protected:
  LaserInHand() : scanner_((place_ / "laser").string()), system_(kLaser, path(), "pty:base") {
    system_.meanwhile([this] { scanner_.turn(); });
  }
  [[nodiscard]] std::string path() const { return (place_ / "laser").string(); }
  void expect_scans() {
    EXPECT_TRUE(system_.goes_on("laser", "scans", 5));
    const auto scan = system_.read<rover::LaserScan>("scan");
    ASSERT_EQ(scan.ranges.size(), 5U);
    EXPECT_FLOAT_EQ(scan.ranges[2], 1.002F);
    EXPECT_FALSE(scan.valid(3));
  }

  TempDir place_;
  HandScanner scanner_;
  System system_;
};

TEST_F(LaserInHand, IsOpenedAgainWhenItIsBack) {
  ASSERT_TRUE(system_.deployed());
  expect_scans();

  scanner_.unplug();
  EXPECT_TRUE(system_.reaches("laser", "device_errors", 1));
  system_.deployer().run_for(1s);
  EXPECT_EQ(system_.observe("laser", "reopened"), 0.0);
  scanner_.plug();

  EXPECT_TRUE(system_.reaches("laser", "reopened", 1));
  expect_scans();
}

TEST_F(LaserInHand, IsAskedAgainAfterGarbageOrAHalfScanForEver) {
  ASSERT_TRUE(system_.deployed());
  expect_scans();

  scanner_.say(std::string(200, 'x'));
  EXPECT_TRUE(system_.goes_on("laser", "timeouts", 1));
  EXPECT_GE(system_.observe("laser", "bad_frames"), 1.0);
  scanner_.say("");
  expect_scans();
  const std::string half = scanner_.a_scan().substr(0, 20);
  scanner_.say(half);
  EXPECT_TRUE(system_.goes_on("laser", "timeouts", 1));
  scanner_.say("");
  expect_scans();
}

TEST_F(LaserInHand, IsAskedUntilItGrantsWhatWasAskedFor) {
  scanner_.refuse(true);
  ASSERT_TRUE(system_.deployed());

  EXPECT_TRUE(system_.reaches("laser", "refused", 2));
  EXPECT_EQ(system_.observe("laser", "scans"), 0.0);
  scanner_.refuse(false);

  expect_scans();
}

/// A base that the test holds in its hands.
class BaseInHand : public testing::Test {
 protected:
  BaseInHand() : path_((place_ / "base").string()) {
    EXPECT_TRUE(line_.open(path_));
    system_.emplace(kBase, "pty:laser", path_);
    system_->meanwhile([this] { turn(); });
  }

  void turn() {
    std::array<char, 512> bytes{};
    const std::size_t count = line_.receive(bytes);
    for (std::size_t i = 0; i < count; ++i) {
      if (const auto command = heard_.push(bytes[i])) {
        begun_ += command->opcode == create::Opcode::stream ? 1 : 0;
        if (command->opcode == create::Opcode::drive_direct) last_ = *command;
      }
    }
    if (silent_) return;
    const create::Frame frame = create::frame_of(report_);
    line_.send({frame.data(), frame.size()});
  }
  /// Until the base has heard these wheel speeds, mm/s.
  [[nodiscard]] bool hears(int left, int right) {
    return system_->run_until([=, this] {
      if (command_) system_->write("safe_command", *command_);
      return last_ && last_->left == left && last_->right == right;
    });
  }

  TempDir place_;
  std::string path_;
  drivers::PseudoTerminal line_;
  create::CommandReader heard_;
  create::Report report_{0, create::Mode::safe, 100, 100};
  std::optional<create::Command> last_;
  std::optional<rover::Velocity> command_;
  int begun_ = 0;
  bool silent_ = false;
  std::optional<System> system_;
};

TEST_F(BaseInHand, StandsWithoutACommandWithAnOldOneAndWithOneThatIsNoNumber) {
  ASSERT_TRUE(system_->deployed());
  EXPECT_TRUE(hears(0, 0));
  command_ = rover::Velocity{0.2, 0.8};
  EXPECT_TRUE(hears(106, 294)) << "0.094 m/s slower and faster";

  command_ = rover::Velocity{0.2, std::numeric_limits<double>::quiet_NaN()};
  EXPECT_TRUE(hears(0, 0));
  EXPECT_GE(system_->observe("base", "bad_commands"), 1.0);

  command_ = rover::Velocity{0.2, 0.0};
  EXPECT_TRUE(hears(200, 200));
  command_.reset();  // nobody writes any more
  EXPECT_TRUE(hears(0, 0));
  EXPECT_EQ(system_->observe("base", "lost_commands"), 1.0);
}

TEST_F(BaseInHand, IsNotDrivenForwardAgainstItsBumper) {
  ASSERT_TRUE(system_->deployed());
  command_ = rover::Velocity{0.2, 0.0};
  EXPECT_TRUE(hears(200, 200));

  report_.contacts = 2;
  EXPECT_TRUE(hears(0, 0));
  EXPECT_EQ(system_->observe("base", "contacts"), 2.0);
  command_ = rover::Velocity{-0.2, 0.0};
  EXPECT_TRUE(hears(-200, -200));
}

TEST_F(BaseInHand, DiscardsTheJumpOfABaseThatBeganAnew) {
  ASSERT_TRUE(system_->deployed());
  EXPECT_TRUE(system_->reaches("base", "frames", 5));
  report_.left = report_.right = 50'000;

  EXPECT_TRUE(system_->reaches("base", "jumps", 1));
  EXPECT_TRUE(system_->goes_on("base", "frames", 5));

  EXPECT_EQ(system_->observe("base", "jumps"), 1.0);
  EXPECT_EQ(system_->read<rover::Odometry>("odometry").x, 0.0);
}

TEST_F(BaseInHand, IsBegunAnewWhenItFallsSilentAndOpenedAgainWhenItIsBack) {
  ASSERT_TRUE(system_->deployed());
  EXPECT_TRUE(system_->reaches("base", "frames", 5));
  silent_ = true;
  const int begun = begun_;
  EXPECT_TRUE(system_->reaches("base", "timeouts", 1));
  EXPECT_TRUE(system_->run_until([&] { return begun_ > begun; }));
  silent_ = false;
  EXPECT_TRUE(system_->goes_on("base", "frames", 5));

  line_.close();
  EXPECT_TRUE(system_->reaches("base", "device_errors", 1));
  ASSERT_TRUE(line_.open(path_));

  EXPECT_TRUE(system_->reaches("base", "reopened", 1));
  EXPECT_TRUE(system_->goes_on("base", "frames", 5));
}

TEST_F(BaseInHand, IsToldToStandWhenItsDriverIsCleanedUp) {
  ASSERT_TRUE(system_->deployed());
  command_ = rover::Velocity{0.2, 0.0};
  EXPECT_TRUE(hears(200, 200));

  system_.reset();

  EXPECT_TRUE(mauve::test::eventually([this] {
    turn();
    return last_->left == 0 && last_->right == 0;
  }));
}

}  // namespace
