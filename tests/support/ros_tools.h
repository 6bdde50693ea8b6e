// SPDX-License-Identifier: LGPL-3.0-or-later
/// A ROS master of our own and the tools of ROS, for tests. Such tests are skipped, with a message,
/// where ROS 1 is not installed. MAUVE_PLUGIN_DIR is defined by the CMakeLists.txt of the test.
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "support/daemon_process.h"

namespace mauve::test {

inline constexpr std::chrono::seconds kLong{
    60};  // a ROS tool takes seconds to start on a busy machine
inline constexpr const char* kMaster = "/usr/bin/rosmaster";
inline constexpr const char* kTopic = "/usr/bin/rostopic";
inline constexpr const char* kBag = "/usr/bin/rosbag";
/// The plugin `ros` is built from these.
#if __has_include(<ros/ros.h>) && __has_include(<nav_msgs/OccupancyGrid.h>)
inline constexpr bool kHasHeadersOfRos = true;
#else
inline constexpr bool kHasHeadersOfRos = false;
#endif

inline sockaddr_in here(int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  return address;
}

/// Does a program listen on this port?
inline bool answers(int port) {
  const int probe = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const sockaddr_in address = here(port);
  const bool connected =
      connect(probe, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  ::close(probe);
  return connected;
}

inline int free_port() {
  const int probe = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address = here(0);
  socklen_t size = sizeof address;
  EXPECT_EQ(bind(probe, reinterpret_cast<sockaddr*>(&address), size), 0);
  EXPECT_EQ(getsockname(probe, reinterpret_cast<sockaddr*>(&address), &size), 0);
  ::close(probe);
  return ntohs(address.sin_port);
}

/// `rosbag` as a child. It works through a child of its own, to which it hands SIGINT on: SIGKILL,
/// the end of any other Process, would leave that child behind.
class Rosbag {
 public:
  explicit Rosbag(std::vector<std::string> words) : process_(with_tool(std::move(words))) {}
  ~Rosbag() { end(); }
  void end() {
    process_.signal(SIGINT);
    EXPECT_TRUE(ended());
  }
  [[nodiscard]] bool ended() {
    return eventually([&] { return !process_.running(); }, kLong);
  }
  /// Ends a recording to `file`. `rosbag` itself ends as soon as it has handed SIGINT on; its child
  /// writes on to FILE.active, and gives it its name when it is complete.
  [[nodiscard]] bool end_recording_to(const std::filesystem::path& file) {
    end();
    return eventually([&] { return std::filesystem::exists(file); }, kLong);
  }
  [[nodiscard]] std::string output() { return process_.all_output(); }

 private:
  static std::vector<std::string> with_tool(std::vector<std::string> words) {
    words.insert(words.begin(), kBag);
    return words;
  }
  Process process_;
};

class RosTools : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* needed : {kMaster, kTopic, kBag}) {
      if (!std::filesystem::exists(needed)) {
        GTEST_SKIP() << "no " << needed << ": scripts/setup installs ROS 1, then build again";
      }
    }
    const std::filesystem::path plugin = MAUVE_PLUGIN_DIR "/ros.so";
    if (!kHasHeadersOfRos && !std::filesystem::exists(plugin)) {
      GTEST_SKIP() << "no headers of ROS 1: scripts/setup installs them, then build again";
    }
    ASSERT_TRUE(std::filesystem::exists(plugin))
        << plugin << " is not built, and the headers of ROS 1 are here; configure the build again";
    port_ = std::to_string(free_port());
    setenv("ROS_MASTER_URI", ("http://127.0.0.1:" + port_).c_str(), 1);
    setenv("ROS_IP", "127.0.0.1", 1);
    setenv("ROS_HOME", place_.path().c_str(), 1);
    setenv("PYTHONUNBUFFERED", "1", 1);
  }

  void start_master() {
    master_ = std::make_unique<Process>(std::vector<std::string>{kMaster, "--core", "-p", port_});
    // Its tools give up when they do not find it.
    EXPECT_TRUE(eventually([&] { return answers(std::stoi(port_)); }, kLong));
  }
  static std::string stamped(double x, double y) {
    return "{pose: {position: {x: " + std::to_string(x) + ", y: " + std::to_string(y) +
           "}, orientation: {w: 0.0, z: 1.0}}}";
  }
  /// `rostopic pub`, until it is dropped.
  static std::unique_ptr<Process> publish(const std::string& topic, double x, double y) {
    return std::make_unique<Process>(std::vector<std::string>{
        kTopic, "pub", "-r", "10", topic, "geometry_msgs/PoseStamped", stamped(x, y)});
  }
  /// The first message that `rostopic echo` shows, as lines.
  static std::string echo(const std::string& topic) {
    Process tool({kTopic, "echo", "-n", "1", topic});
    (void)eventually([&] { return !tool.running(); }, kLong);
    return tool.all_output();
  }

  TempDir place_;
  std::string port_;
  std::unique_ptr<Process> master_;
};

}  // namespace mauve::test
