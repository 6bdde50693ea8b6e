// SPDX-License-Identifier: LGPL-3.0-or-later
/// Plugin ros in a real daemon, with a real master and the tools of ROS at the other end. Skipped,
/// and says so, where ROS 1 is not installed.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <array>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "support/daemon_process.h"
#include "support/input_events.h"
#include "support/ros_tools.h"

namespace {

using mauve::test::DaemonProcess;
using mauve::test::eventually;
using mauve::test::InputEvents;
using mauve::test::kLong;
using mauve::test::kTopic;
using mauve::test::Process;
using mauve::test::RosTools;

// Two jobs a second: one that waited for ROS would miss some, one on a busy machine does not.
constexpr const char* kArchitecture = R"({
  "schema": "mauve/architecture/1",
  "name": "ros",
  "plugins": ["types", "ros"],
  "resources": {
    "goal":     { "type": "ros/subscribe_goal", "properties": { "shell.topic": "/goal" } },
    "goal_out": { "type": "ros/publish_goal", "properties": { "shell.topic": "/goal_out" } },
    "pose_in":  { "type": "ros/subscribe_pose", "properties": { "shell.topic": "/pose_in" } },
    "pose":     { "type": "ros/publish_pose",
                  "properties": { "shell.topic": "/pose", "shell.frame": "world" } }
  },
  "components": {
    "goals": { "type": "ros/relay_goal", "properties": { "fsm.period": "500ms" },
               "ports": { "from": "goal.read", "to": "goal_out.write" } },
    "poses": { "type": "ros/relay_pose", "properties": { "fsm.period": "500ms" },
               "ports": { "from": "pose_in.read", "to": "pose.write" } }
  }
})";

constexpr const char* kJoystick = R"({
  "schema": "mauve/architecture/1",
  "name": "joystick",
  "plugins": ["types", "teleop", "ros"],
  "resources": {
    "joy_out":  { "type": "ros/publish_joy", "properties": { "shell.topic": "/joy" } },
    "joy":      { "type": "ros/subscribe_joy", "properties": { "shell.topic": "/joy" } },
    "priority": { "type": "teleop/priority" },
    "teleop":   { "type": "teleop/teleop", "ports": { "velocity": "priority.teleop" } }
  },
  "components": {
    "joystick": { "type": "teleop/joystick", "properties": { "core.device": "DEVICE" },
                  "ports": { "joystick": "joy_out.write" } },
    "relay":    { "type": "ros/relay_joy",
                  "ports": { "from": "joy.read", "to": "teleop.joystick" } }
  }
})";

constexpr std::array kTypes{"joy", "goal", "velocity", "scan", "odometry", "pose", "imu", "map"};

/// A publisher and a subscriber of each type, on one topic.
std::string one_of_each() {
  nlohmann::json file{{"schema", "mauve/architecture/1"},
                      {"name", "types"},
                      {"plugins", {"types", "ros"}},
                      {"components", nlohmann::json::object()}};
  for (const std::string type : kTypes) {
    for (const std::string way : {"publish_", "subscribe_"}) {
      file["resources"][way + type] = {{"type", "ros/" + way + type},
                                       {"properties", {{"shell.topic", "/all/" + type}}}};
    }
  }
  return file.dump();
}

class Ros : public RosTools {
 protected:
  void start_daemon(const std::string& architecture = kArchitecture) {
    daemon_ = std::make_unique<DaemonProcess>(place_.write("ros.json", architecture));
    ASSERT_TRUE(daemon_->up()) << daemon_->errors();
  }
  void start_both() {
    start_master();
    start_daemon();
    ASSERT_TRUE(all_are_connected(true));
  }
  [[nodiscard]] bool all_are_connected(bool connected) {
    return eventually(
        [&] {
          for (const char* name : {"goal", "goal_out", "pose_in", "pose"}) {
            if (value(std::string(name) + ".core.connected") != connected) return false;
          }
          return true;
        },
        kLong);
  }
  [[nodiscard]] nlohmann::json value(const std::string& address) { return daemon_->value(address); }

  std::uint64_t releases() { return value("goals.releases").get<std::uint64_t>(); }
  void expect_runs_on() {
    const std::uint64_t before = releases();
    EXPECT_TRUE(eventually([&] { return releases() > before + 5; }, kLong));
  }
  /// A wait for ROS takes seconds, that is several releases. A start on a busy machine, or a stall
  /// of it, may cost one.
  void expect_not_held_up() {
    for (const char* name : {"goals", "poses"}) {
      EXPECT_LE(value(std::string(name) + ".missed").get<int>(), 2) << name << daemon_->errors();
    }
  }

  std::unique_ptr<DaemonProcess> daemon_;
};

TEST_F(Ros, BringsAGoalToTheRobot) {
  start_both();
  const auto tool = publish("/goal", 3.5, -1.5);

  EXPECT_TRUE(eventually([&] { return value("goals.core.relayed") > 0; }, kLong));
  EXPECT_EQ(value("goal.core.refused"), 0);
  EXPECT_NE(echo("/goal_out").find("x: 3.5\n    y: -1.5\n"), std::string::npos);
  expect_not_held_up();
}

TEST_F(Ros, ASubscriberThatHearsNothingSaysWhy) {
  start_both();
  EXPECT_TRUE(eventually([&] { return value("pose_in.core.silent") == true; }, kLong));
  const std::string status = daemon_->ask({"status"}).dump();
  EXPECT_NE(status.find("nobody publishes its topic"), std::string::npos) << status;
  EXPECT_TRUE(value("goal.core.silent").is_null()) << "one goal is enough";

  const auto tool = publish("/pose_in", 2.0, 4.0);

  EXPECT_TRUE(eventually([&] { return value("pose_in.core.silent") == false; }, kLong));
}

TEST_F(Ros, ShowsThePoseOfTheRobot) {
  start_both();
  const auto tool = publish("/pose_in", 2.0, 4.0);

  const std::string shown = echo("/pose");

  EXPECT_NE(shown.find("frame_id: \"world\""), std::string::npos) << shown;
  EXPECT_NE(shown.find("x: 2.0\n    y: 4.0\n"), std::string::npos) << shown;
  EXPECT_NE(shown.find("z: 1.0\n"), std::string::npos) << shown;  // half a turn
  EXPECT_EQ(shown.find("secs: 0\n"), std::string::npos) << shown;
  EXPECT_TRUE(eventually([&] { return value("pose.core.subscribers") == 0; }, kLong));
}

TEST_F(Ros, ConnectsAPublisherAndASubscriberOfEachType) {
  start_master();
  start_daemon(one_of_each());
  for (const std::string type : kTypes) {
    EXPECT_TRUE(
        eventually([&] { return value("subscribe_" + type + ".core.publishers") == 1; }, kLong))
        << type;
    EXPECT_EQ(value("publish_" + type + ".core.connected"), true) << type;
  }
}

TEST_F(Ros, LetsAJoystickOnATopicSteer) {
  const std::string device = (place_ / "joystick").string();
  ASSERT_EQ(mkfifo(device.c_str(), 0600), 0);
  std::string text = kJoystick;
  text.replace(text.find("DEVICE"), 6, device);
  start_daemon(text);  // the first values are written while there is no master
  start_master();
  ASSERT_TRUE(eventually([&] { return value("joy.core.received") > 0; }, kLong));
  EXPECT_EQ(value("teleop.core.steering"), false);

  std::ofstream stick(device, std::ios::binary);
  stick << InputEvents().key(BTN_TRIGGER, 1).axis(ABS_Y, -32767).report().bytes() << std::flush;

  EXPECT_TRUE(eventually([&] { return value("teleop.core.steering") == true; }, kLong));
  EXPECT_TRUE(eventually([&] { return value("priority.core.selected") == 2; }, kLong));
  stick.close();
  EXPECT_TRUE(eventually([&] { return value("teleop.core.steering") == false; }, kLong));
}

TEST_F(Ros, RunsWithoutAMasterAndFindsOneThatComes) {
  start_daemon();
  EXPECT_EQ(value("goal.core.connected"), false);
  expect_runs_on();

  EXPECT_TRUE(daemon_->says("goals: no ROS master knows its topic")) << daemon_->errors();
  start_master();
  ASSERT_TRUE(all_are_connected(true));
  const auto tool = publish("/goal", 1.0, 0.0);
  EXPECT_TRUE(eventually([&] { return value("goals.core.relayed") > 0; }, kLong));
  expect_not_held_up();
}

TEST_F(Ros, ComesBackWithANewMasterWhileAllOthersGoOn) {
  start_both();
  {
    const auto tool = publish("/goal", 1.0, 0.0);
    ASSERT_TRUE(eventually([&] { return value("goals.core.relayed") > 0; }, kLong));
  }
  master_.reset();
  ASSERT_TRUE(all_are_connected(false));
  expect_runs_on();

  start_master();
  ASSERT_TRUE(all_are_connected(true));
  // A subscriber that comes later still gets the last goal, which the old master's topic had.
  EXPECT_NE(echo("/goal_out").find("x: 1.0\n"), std::string::npos);
  const auto before = value("goal.core.received");
  const auto tool = publish("/goal", 2.0, 0.0);
  EXPECT_TRUE(eventually([&] { return value("goal.core.received") > before; }, kLong));
  expect_not_held_up();
}

TEST_F(Ros, RefusesWhatRoscppWouldEndTheProcessFor) {
  start_both();
  const auto refusal = [&](const std::string& change) {
    return daemon_->ask({"set", change}).dump();
  };
  EXPECT_NE(refusal("goal.core.node=9lives").find("no name of a ROS node"), std::string::npos);
  EXPECT_NE(refusal("goal.core.master=host").find("http://host:port"), std::string::npos);
  EXPECT_NE(refusal("goal.core.node=other").find("already"), std::string::npos);

  const auto tool = publish("/goal", 1.0, 0.0);
  EXPECT_TRUE(eventually([&] { return value("goals.core.relayed") > 0; }, kLong));
}

TEST_F(Ros, RefusesAFileWithATopicThatIsNone) {
  std::string text = kArchitecture;
  text.replace(text.find("/goal_out"), 9, "/goal out");
  daemon_ = std::make_unique<DaemonProcess>(place_.write("ros.json", text));

  EXPECT_NE(daemon_->process().wait(), 0);
  EXPECT_NE(daemon_->errors().find("no name of a ROS topic"), std::string::npos)
      << daemon_->errors();
}

TEST_F(Ros, HandsItsTopicsOverToANewCore) {
  start_both();
  ASSERT_EQ(daemon_->client({"set", "goal.core.master=http://127.0.0.1:" + port_}).wait(), 0);
  const auto tool = publish("/goal", 1.0, 0.0);

  EXPECT_TRUE(eventually([&] { return value("goals.core.relayed") > 0; }, kLong));
  EXPECT_TRUE(eventually([&] { return value("goal.core.publishers") == 1; }, kLong));
  expect_not_held_up();
}

TEST_F(Ros, GoesOnThroughAReloadOfItsOwnCode) {
  start_both();
  const nlohmann::json reloaded = daemon_->ask({"reload", "ros"});
  EXPECT_EQ(reloaded["unmapped"], false) << reloaded;  // roscpp's threads may come back into it
  ASSERT_TRUE(all_are_connected(true));
  const auto tool = publish("/goal", 1.0, 0.0);

  EXPECT_TRUE(eventually([&] { return value("goals.core.relayed") > 0; }, kLong));
  EXPECT_NE(echo("/goal_out").find("x: 1.0\n"), std::string::npos);
}

TEST_F(Ros, EndsInOrderAndLeavesNoTopicBehind) {
  start_both();
  daemon_->process().signal(SIGTERM);
  EXPECT_EQ(daemon_->process().wait(), 0) << daemon_->errors();

  const auto tool = publish("/of_another", 1.0, 0.0);
  std::string topics;
  EXPECT_TRUE(eventually(
      [&] {
        Process list({kTopic, "list"});
        topics = list.all_output();
        return list.wait() == 0 && topics.find("/of_another") != std::string::npos;
      },
      kLong))
      << topics;
  EXPECT_EQ(topics.find("goal"), std::string::npos) << topics;
}

TEST_F(Ros, KeepsRoscppFromTalkingIntoTheDaemonsOutput) {
  start_daemon();
  start_master();
  ASSERT_TRUE(all_are_connected(true));
  master_.reset();
  ASSERT_TRUE(all_are_connected(false));
  daemon_->process().signal(SIGTERM);
  EXPECT_EQ(daemon_->process().wait(), 0);

  for (const char* word : {"ERROR]", "WARN]", "INFO]", "log4cxx"}) {
    EXPECT_EQ(daemon_->errors().find(word), std::string::npos) << daemon_->errors();
  }
  for (const std::string& line : daemon_->process().lines()) {
    EXPECT_EQ(line.find('\x1b'), std::string::npos) << line;  // roscpp talks in colours
  }
}

}  // namespace
