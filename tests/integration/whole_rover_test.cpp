// SPDX-License-Identifier: LGPL-3.0-or-later
/// etc/rover.json as it is, in a real daemon: the whole robot drives through the building, on
/// threads, with every device at the other end of a pseudo-terminal.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>

#include <mauve/serial/serial_port.h>

#include "support/daemon_process.h"
#include "support/input_events.h"
#include "support/ros_tools.h"

namespace {

using mauve::test::DaemonProcess;
using mauve::test::eventually;
using mauve::test::InputEvents;
using mauve::test::Process;
using mauve::test::Rosbag;
using mauve::test::RosTools;
using mauve::test::TempDir;
using nlohmann::json;

constexpr std::chrono::seconds kDrive{150};  // it takes 40 when nothing else runs

const std::filesystem::path kArchitecture =
    std::filesystem::path(MAUVE_SOURCE_DIR) / "etc" / "rover.json";

bool within(const std::function<bool()>& condition) {
  return eventually(
      [&] {
        std::this_thread::sleep_for(std::chrono::milliseconds(50));  // a robot is in no hurry
        return condition();
      },
      kDrive);
}

double number_of(const DaemonProcess& rover, const std::string& address) {
  const auto value = rover.value(address);
  return value.is_number() ? value.get<double>() : 0.0;
}

class WholeRover : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(rover_.up()) << rover_.errors(); }

  double number(const std::string& address) { return number_of(rover_, address); }
  std::string core() { return rover_.ask({"show", "control"})["core"]; }
  bool gnss_is_used() { return rover_.ask({"show", "gnss.ports.fix"})["service"] != nullptr; }
  void set(const std::string& assignment) {
    // A host that stands still makes jobs late, and a change on probation would be rolled back.
    const json answer = rover_.ask({"set", assignment, "--probation", "off"});
    ASSERT_EQ(answer.value("state", ""), "applied") << answer;
  }
  /// Shows where it stands when something did not happen.
  std::string where() {
    return rover_.ask({"get", "localization.predict"}).dump() + "\n" +
           rover_.ask({"rules"}).dump() + "\n" + rover_.errors();
  }

  TempDir place_;
  DaemonProcess rover_{kArchitecture, {"--allow-path", place_.path().string()}};
};

TEST_F(WholeRover, DrivesFromTheYardIntoTheBuildingAndChangesItsCoreOnTheWay) {
  set(R"(mission.core.goal={"x":10.0,"y":5.0})");
  EXPECT_EQ(core(), "guidance/finite_time");

  EXPECT_TRUE(within([&] { return core() == "guidance/potential_field"; })) << where();
  EXPECT_EQ(number("supervisor.core.area"), 0);
  EXPECT_EQ(number("control.core.speed"), 0.45) << "the values come with the core";
  EXPECT_TRUE(within([&] { return number("navigation.core.goals_reached") == 1; })) << where();

  EXPECT_NEAR(number("world.core.x"), 10.0, 1.0);
  EXPECT_NEAR(number("world.core.y"), 5.0, 1.0);
  EXPECT_GT(number("world.core.nearest"), 0.0) << "from hull to wall, all the way";
}

TEST_F(WholeRover, GoesOnWithoutSatellitesAndTakesThemBack) {
  set(R"(mission.core.goal={"x":5.0,"y":-1.0})");
  ASSERT_TRUE(within([&] { return gnss_is_used() && number("world.core.x") > 0.5; })) << where();

  set("world.core.satellites=3");
  EXPECT_TRUE(within([&] { return !gnss_is_used(); })) << where();
  EXPECT_TRUE(within([&] { return number("navigation.core.goals_reached") == 1; })) << where();
  EXPECT_FALSE(gnss_is_used());
  EXPECT_TRUE(rover_.says("drop_gnss by rule gnss_lost")) << rover_.errors();
  EXPECT_NEAR(number("world.core.x"), 5.0, 1.0) << "wheels and gyroscope know the way";
  EXPECT_NEAR(number("world.core.y"), -1.0, 1.0);

  set("world.core.satellites=9");
  EXPECT_TRUE(within([&] { return gnss_is_used(); })) << where();
}

TEST_F(WholeRover, ObeysAJoystickAtOnceAndStandsWhenThatIsPulledOut) {
  const std::string device = (place_ / "joystick").string();
  ASSERT_EQ(mkfifo(device.c_str(), 0600), 0);
  set("joystick.core.device=" + device);
  ASSERT_TRUE(within([&] { return number("world.core.x") > 0.5; })) << where();
  mauve::serial::Descriptor human;
  const auto plug = [&] {
    human = mauve::serial::Descriptor(open(device.c_str(), O_WRONLY | O_NONBLOCK | O_CLOEXEC));
    return human.open();
  };
  ASSERT_TRUE(eventually(plug));
  const std::string turn = InputEvents().key(BTN_TRIGGER, 1).axis(ABS_X, -32767).report().bytes();

  // A hand moves a little all the time; without an event for 3 s all counts as let go.
  const auto holds = [&] {
    return write(human.number(), turn.data(), turn.size()) == static_cast<ssize_t>(turn.size());
  };
  EXPECT_TRUE(within([&] { return holds() && number("priority.core.selected") == 2; })) << where();
  EXPECT_TRUE(within([&] { return holds() && number("safe_command.read.angular") == 1.0; }))
      << where();

  human = mauve::serial::Descriptor();
  EXPECT_TRUE(within([&] { return number("priority.core.selected") == 1; })) << where();
  EXPECT_EQ(number("priority.core.take_overs"), 1);
  EXPECT_TRUE(rover_.says("joystick: its joystick is gone")) << rover_.errors();
}

/// The rover with the elements of ROS. `mission` leaves; rostopic gives the goals.
json with_ros(json system) {
  system["resources"].update(json::parse(R"({
    "ros_goal": { "type": "ros/subscribe_goal", "properties": { "shell.topic": "/goal" } },
    "ros_pose": { "type": "ros/publish_pose", "properties": { "shell.topic": "/pose" } },
    "ros_scan": { "type": "ros/publish_scan", "properties": { "shell.topic": "/scan" } }
  })"));
  system["components"].erase("mission");
  system["components"].update(json::parse(R"({
    "goal_relay": { "type": "ros/relay_goal", "properties": { "fsm.period": "100ms" },
                    "ports": { "from": "ros_goal.read", "to": "goal.write" } },
    "pose_relay": { "type": "ros/relay_pose", "properties": { "fsm.period": "100ms" },
                    "ports": { "from": "localization.pose", "to": "ros_pose.write" } },
    "scan_relay": { "type": "ros/relay_scan", "properties": { "fsm.period": "100ms" },
                    "ports": { "from": "scan.read", "to": "ros_scan.write" } }
  })"));
  return system;
}

class WholeRoverWithRos : public RosTools {
 protected:
  void let_ros_join(DaemonProcess& rover) {
    ASSERT_TRUE(rover.up()) << rover.errors();
    ASSERT_TRUE(rover.ask({"load", "ros"}).contains("generation")) << rover.errors();
    const auto file = place_.write("with_ros.json", with_ros(rover.ask({"export"})).dump());
    const json applied = rover.ask({"apply", file.string()});
    ASSERT_EQ(applied.value("state", ""), "applied") << applied;
  }
};

TEST_F(WholeRoverWithRos, DrivesToAGoalFromRostopicAndGoesOnWhenTheMasterDies) {
  start_master();
  DaemonProcess rover(kArchitecture, {});
  ASSERT_NO_FATAL_FAILURE(let_ros_join(rover));

  {
    const auto tool = publish("/goal", 5.0, -1.0);
    ASSERT_TRUE(within([&] { return number_of(rover, "goal.read.x") == 5.0; }));
  }
  ASSERT_TRUE(within([&] { return number_of(rover, "world.core.x") > 1.0; })) << rover.errors();
  master_.reset();
  EXPECT_TRUE(within([&] { return rover.value("ros_pose.core.connected") == false; }));
  EXPECT_TRUE(within([&] { return number_of(rover, "navigation.core.goals_reached") == 1; }))
      << rover.errors();

  start_master();
  ASSERT_TRUE(within([&] { return rover.value("ros_pose.core.connected") == true; }));
  EXPECT_THAT(echo("/pose"), testing::ContainsRegex("position: \n    x: [45]\\."));
}

/// The content of the bag of a drive: two messages of its pose, and its scans.
constexpr const char* kReadBag = R"(
import rosbag, sys
said = {"/pose": [], "/scan": []}
for topic, message, time in rosbag.Bag(sys.argv[1]).read_messages(): said[topic].append(message)
first, last = said["/pose"][0].pose.position, said["/pose"][-1].pose.position
scan = said["/scan"][-1]
print("from %.0f to %.0f," % (first.x, last.x), "many" if len(said["/scan"]) > 50 else "few",
      "scans of", len(scan.ranges), scan.header.frame_id)
)";

TEST_F(WholeRoverWithRos, DrivesToAGoalThatRosbagPlaysAndIsRecordedByIt) {
  start_master();
  const std::string goal = place_ / "goal.bag";
  const std::string drive = place_ / "drive.bag";
  {
    Rosbag recorder({"record", "-l", "5", "-O", goal, "/goal"});
    const auto tool = publish("/goal", 5.0, -1.0);
    ASSERT_TRUE(recorder.ended());
  }
  DaemonProcess rover(kArchitecture, {});
  ASSERT_NO_FATAL_FAILURE(let_ros_join(rover));
  Rosbag recorder({"record", "-O", drive, "/pose", "/scan"});
  ASSERT_TRUE(within([&] {
    return rover.value("ros_pose.core.subscribers") == 1 &&
           rover.value("ros_scan.core.subscribers") == 1;
  })) << rover.errors();

  Rosbag player({"play", "-d", "3", goal});
  ASSERT_TRUE(within([&] { return number_of(rover, "goal.read.x") == 5.0; })) << player.output();
  EXPECT_TRUE(within([&] { return number_of(rover, "navigation.core.goals_reached") == 1; }))
      << rover.errors();
  ASSERT_TRUE(recorder.end_recording_to(drive));

  Rosbag info({"info", drive});
  ASSERT_TRUE(info.ended());
  const std::string listed = info.output();
  EXPECT_NE(listed.find("geometry_msgs/PoseStamped"), std::string::npos) << listed;
  EXPECT_NE(listed.find("sensor_msgs/LaserScan"), std::string::npos) << listed;
  Process reader({"/usr/bin/python3", "-c", kReadBag, drive});
  ASSERT_TRUE(eventually([&] { return !reader.running(); }, mauve::test::kLong));
  // rosbag writes its first message up to some seconds after the rover counts it as a subscriber.
  EXPECT_THAT(reader.all_output(), testing::ContainsRegex("from [0-3] to [45], many scans of 541"));
}

}  // namespace
