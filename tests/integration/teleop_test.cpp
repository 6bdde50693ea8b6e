// SPDX-License-Identifier: LGPL-3.0-or-later
/// A joystick at the other end of a FIFO takes over a driving robot. The real plugins run on a
/// simulated clock, so "within one period" is a count and not a measurement.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <memory>
#include <string>

#include <mauve/host/architecture.h>
#include <mauve/host/deployer.h>
#include <mauve/serial/serial_port.h>

#include "../../plugins/types/velocity.h"
#include "arch/build/load.h"
#include "plugin/load/catalog.h"
#include "support/eventually.h"
#include "support/input_events.h"
#include "support/proved_deployer.h"
#include "support/temp_dir.h"

namespace {

using namespace std::chrono_literals;  // NOLINT: durations
using mauve::Value;
using mauve::test::eventually;
using mauve::test::InputEvents;
using mauve::test::TempDir;
using rover::Velocity;

// The pilot sees no scan, so it lets the robot turn and reverse only: that is enough to show who
// drives.
constexpr const char* kArchitecture = R"({
  "schema": "mauve/architecture/1",
  "name": "teleop",
  "plugins": ["types", "safety", "teleop"],
  "resources": {
    "scan":         { "type": "shared_data", "data": "laser_scan/1" },
    "safe_command": { "type": "shared_data", "data": "velocity/1" },
    "priority":     { "type": "teleop/priority" },
    "teleop":       { "type": "teleop/teleop", "ports": { "velocity": "priority.teleop" } }
  },
  "components": {
    "joystick": { "type": "teleop/joystick", "properties": { "core.device": "DEVICE" },
      "ports": { "joystick": "teleop.joystick" }, "task": { "priority": 60 } },
    "cruise": { "type": "safety/cruise",
      "properties": { "core.velocity": { "linear": -0.3, "angular": 0.1 }, "fsm.period": "50ms" },
      "ports": { "command": "priority.command" }, "task": { "priority": 40 } },
    "pilot": { "type": "safety/pilot", "properties": { "fsm.period": "10ms" },
      "ports": { "command": "priority.read", "scan": "scan.read",
                 "safe_command": "safe_command.write" },
      "task": { "priority": 50 } }
  }
})";

class Teleop : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(mkfifo(device_.c_str(), 0600), 0);
    std::string text = kArchitecture;
    text.replace(text.find("DEVICE"), 6, device_);
    mauve::arch::Problems problems;
    architecture_ = mauve::arch::load(text, catalog_, problems);
    ASSERT_TRUE(architecture_ != nullptr);
    deployer_ = std::make_unique<mauve::test::ProvedDeployer>(
        *architecture_, mauve::DeployOptions{mauve::Realtime::off, true, mauve::Admission::warn});
    const mauve::Status up = deployer_->deploy();
    ASSERT_TRUE(up) << (up ? "" : to_string(up.error()));
    deployer_->run_for(100ms);
  }

  /// Somebody plugs the joystick in. Here as below: and its line, which runs in real time, knows.
  void plug() {
    const auto before = observe("joystick", "received");
    ASSERT_TRUE(eventually([&] {
      writer_ = mauve::serial::Descriptor(open(device_.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC));
      if (!writer_.open()) deployer_->run_for(100ms);  // it is looked for
      return writer_.open();
    }));
    ASSERT_TRUE(has_arrived(before, sizeof(input_event)));
  }
  void unplug() {
    const auto before = observe("joystick", "received");
    writer_ = mauve::serial::Descriptor();
    ASSERT_TRUE(has_arrived(before, sizeof(input_event)));
  }
  void send(const InputEvents& events) {
    const auto before = observe("joystick", "received");
    const std::string& bytes = events.bytes();
    ASSERT_EQ(write(writer_.number(), bytes.data(), bytes.size()),
              static_cast<ssize_t>(bytes.size()));
    ASSERT_TRUE(has_arrived(before, bytes.size()));
  }
  bool has_arrived(std::int64_t before, std::size_t bytes) {
    const auto enough = before + static_cast<std::int64_t>(bytes);
    return eventually([&] { return observe("joystick", "received") >= enough; });
  }
  static InputEvents full_left() {
    return InputEvents().key(BTN_TRIGGER, 1).axis(ABS_X, -32767).report();
  }
  static InputEvents let_go() { return InputEvents().key(BTN_TRIGGER, 0).report(); }

  /// The turn rate that reaches the robot.
  double turn() {
    mauve::ServiceBase& service = **architecture_->find_service("safe_command.read");
    mauve::Cursor cursor{service.attach(), 0, 0};
    Velocity velocity;
    EXPECT_TRUE(has_value(service.read(&velocity, cursor)));
    service.detach(cursor.slot);
    return velocity.angular;
  }
  std::int64_t observe(const std::string& owner, const std::string& name) {
    const auto* component = architecture_->find_component(owner);
    const mauve::CoreBase& core =
        component != nullptr ? component->core() : architecture_->find_resource(owner)->core();
    const Value value = core.find_observable(name)->value();
    if (const auto* yes = value.get_if<bool>()) return *yes ? 1 : 0;
    return *value.get_if<std::int64_t>();
  }
  void expect_nothing_missed() {
    for (const auto& status : deployer_->status()) EXPECT_EQ(status.missed, 0U) << status.name;
  }

  TempDir place_;
  std::string device_ = (place_ / "joystick").string();
  mauve::plugin::Catalog catalog_{{MAUVE_PLUGIN_DIR}};
  std::unique_ptr<mauve::Architecture> architecture_;
  std::unique_ptr<mauve::test::ProvedDeployer> deployer_;
  mauve::serial::Descriptor writer_;
};

TEST_F(Teleop, LetsTheCommandThroughWhileNobodySteers) {
  EXPECT_DOUBLE_EQ(turn(), 0.1);
  plug();
  deployer_->run_for(200ms);

  EXPECT_EQ(observe("joystick", "connected"), 1);
  EXPECT_DOUBLE_EQ(turn(), 0.1);
  EXPECT_EQ(observe("priority", "selected"), 1);
}

TEST_F(Teleop, TakesOverWithinOneControlPeriod) {
  plug();
  for (int round = 1; round <= 20; ++round) {
    // At any time: the events come at another phase of the control loop in each round.
    deployer_->run_for(mauve::Duration{400ms} + round * 1'700us);
    ASSERT_DOUBLE_EQ(turn(), 0.1) << round;
    send(full_left());
    deployer_->run_for(10ms);
    ASSERT_DOUBLE_EQ(turn(), 1.0) << round;
    send(let_go());
    deployer_->run_for(10ms);
    ASSERT_DOUBLE_EQ(turn(), 0.0) << round;
    ASSERT_EQ(observe("priority", "take_overs"), round);
  }
  expect_nothing_missed();
}

TEST_F(Teleop, KeepsTheRobotWhileTheStickIsHeldStill) {
  plug();
  send(full_left());
  deployer_->run_for(10s);

  EXPECT_DOUBLE_EQ(turn(), 1.0);
  EXPECT_EQ(observe("priority", "take_overs"), 1);
}

/// The receiver of a wireless joystick stays plugged in when the joystick is out of reach.
TEST_F(Teleop, LetsGoOfTheRobotWhenNoEventComesForSoLong) {
  ASSERT_TRUE(deployer_->set("joystick.core.event_timeout", Value("3s")));
  deployer_->run_for(200ms);  // the new core has a line of its own
  plug();
  send(full_left());
  deployer_->run_for(2900ms);
  EXPECT_DOUBLE_EQ(turn(), 1.0);
  send(full_left());
  deployer_->run_for(2900ms);
  EXPECT_DOUBLE_EQ(turn(), 1.0) << "a hand moves a little";

  deployer_->run_for(110ms);
  EXPECT_DOUBLE_EQ(turn(), 0.0);
  EXPECT_EQ(observe("joystick", "silent"), 1);

  send(InputEvents().axis(ABS_Y, 100).report());
  deployer_->run_for(300ms);
  EXPECT_DOUBLE_EQ(turn(), 0.1) << "what was held may be let go by now";
  EXPECT_EQ(observe("joystick", "silent"), 0);
  send(full_left());
  deployer_->run_for(10ms);
  EXPECT_DOUBLE_EQ(turn(), 1.0);
}

/// /dev/input/js0 has events of eight bytes.
TEST_F(Teleop, SaysThatItsDeviceSendsNoEventsOfAnInputDevice) {
  plug();
  std::string other;
  for (int i = 0; i < 900; ++i) {
    other.append({static_cast<char>(i % 100 + 1), 7, 0, 0, 1, 2, 2, static_cast<char>(i % 8)});
  }
  const auto before = observe("joystick", "received");
  ASSERT_EQ(write(writer_.number(), other.data(), other.size()),
            static_cast<ssize_t>(other.size()));
  ASSERT_TRUE(has_arrived(before, other.size()));
  deployer_->run_for(100ms);

  EXPECT_EQ(observe("joystick", "silent"), 1);
  EXPECT_EQ(observe("joystick", "reports"), 0);
}

TEST_F(Teleop, StandsStillForTheTimeOutAndThenGivesTheRobotBack) {
  plug();
  send(full_left());
  deployer_->run_for(100ms);
  send(let_go());
  deployer_->run_for(190ms);
  EXPECT_DOUBLE_EQ(turn(), 0.0);

  deployer_->run_for(40ms);
  EXPECT_DOUBLE_EQ(turn(), 0.1);
  EXPECT_EQ(observe("teleop", "steering"), 0);
}

TEST_F(Teleop, StopsTheRobotWithinOneControlPeriodWhenTheJoystickIsUnplugged) {
  plug();
  send(full_left());
  deployer_->run_for(100ms);
  unplug();
  deployer_->run_for(10ms);

  EXPECT_DOUBLE_EQ(turn(), 0.0);
  EXPECT_EQ(observe("joystick", "device_errors"), 1);
  EXPECT_EQ(observe("joystick", "connected"), 0);
}

TEST_F(Teleop, ForgetsWhatWasHeldWhenTheJoystickComesBack) {
  plug();
  send(full_left());
  deployer_->run_for(100ms);
  unplug();
  deployer_->run_for(500ms);
  plug();
  deployer_->run_for(500ms);
  EXPECT_EQ(observe("joystick", "reopened"), 1);
  EXPECT_DOUBLE_EQ(turn(), 0.1);

  send(full_left());
  deployer_->run_for(10ms);
  EXPECT_DOUBLE_EQ(turn(), 1.0);
}

TEST_F(Teleop, FindsADeviceThatIsMadeAnew) {
  plug();
  deployer_->run_for(50ms);
  unplug();
  std::filesystem::remove(device_);
  deployer_->run_for(1s);
  ASSERT_EQ(mkfifo(device_.c_str(), 0600), 0);
  plug();
  send(full_left());
  deployer_->run_for(10ms);

  EXPECT_DOUBLE_EQ(turn(), 1.0);
  expect_nothing_missed();
}

TEST_F(Teleop, GivesTheRobotBackWhenItsOwnDriverIsStopped) {
  plug();
  send(full_left());
  deployer_->run_for(100ms);
  ASSERT_TRUE(deployer_->stop({"joystick"}));
  deployer_->run_for(10ms);
  EXPECT_EQ(observe("teleop", "steering"), 0);

  deployer_->run_for(300ms);
  EXPECT_DOUBLE_EQ(turn(), 0.1);
}

TEST_F(Teleop, StandsStillWhenEverySourceIsSilent) {
  ASSERT_TRUE(deployer_->stop({"cruise"}));
  deployer_->run_for(300ms);

  EXPECT_DOUBLE_EQ(turn(), 0.0);
  EXPECT_EQ(observe("priority", "selected"), 0);
}

TEST_F(Teleop, GoesOnSteeringThroughAChangeOfItsOwnProperties) {
  plug();
  send(full_left());
  deployer_->run_for(100ms);
  ASSERT_TRUE(deployer_->set("teleop.core.max_angular", Value(0.5)));
  deployer_->run_for(20ms);
  EXPECT_DOUBLE_EQ(turn(), 0.5);

  send(let_go());
  deployer_->run_for(10ms);
  EXPECT_DOUBLE_EQ(turn(), 0.0);
}

}  // namespace
