// SPDX-License-Identifier: LGPL-3.0-or-later
// Paths that a request sets: a component opens and creates nothing outside of the declared places,
// and no path makes a hook wait.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "support/daemon_process.h"

namespace mauve::test {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr const char* kRobot = R"({
  "schema": "mauve/architecture/1",
  "name": "robot",
  "plugins": ["types", "drivers", "navigation"],
  "resources": {
    "fix": { "type": "shared_data", "data": "gnss_fix/1" },
    "map": { "type": "shared_data", "data": "occupancy_grid/1" },
    "world": { "type": "drivers/world" }
  },
  "components": {
    "gnss": { "type": "drivers/gnss", "properties": { "core.device": "gnss.nmea" },
              "ports": { "fix": "fix.write" } },
    "receiver": { "type": "drivers/receiver_sim", "properties": { "core.line": "pty:first" },
                  "ports": { "antenna": "world.antenna" } },
    "map_server": { "type": "navigation/map_server", "properties": { "core.file": "map.yaml" },
                    "ports": { "map": "map.write" } }
  }
})";

/// A robot whose file names plain files beside it.
class Paths : public testing::Test {
 protected:
  void SetUp() override {
    static_cast<void>(place_.write("gnss.nmea", ""));
    static_cast<void>(
        place_.write("map.yaml", "image: map.pgm\nresolution: 0.1\norigin: [0, 0, 0]\n"));
    static_cast<void>(place_.write("map.pgm", "P2\n2 2\n255\n254 254\n254 0\n"));
    fs::copy_file(place_ / "map.yaml", place_ / "other.yaml");
    mkfifo((place_ / "pipe").c_str(), 0600);
    daemon_.emplace(place_.write("robot.json", kRobot),
                    std::vector<std::string>{"--realtime", "off"});
    ASSERT_TRUE(daemon_->up()) << daemon_->errors();
  }
  /// The name of the error, or empty when it was set.
  std::string set(const std::string& address, const std::string& path) {
    const auto answer = daemon_->ask({"set", address + "=" + path, "--probation", "off"});
    return answer.contains("error") ? answer["error"].value("name", answer.dump()) : "";
  }

  // Not below /dev, where other folders of tests may be: no path that leads to files is allowed
  // there.
  TempDir place_{"/tmp"};
  TempDir other_{"/tmp"};
  std::optional<DaemonProcess> daemon_;
};

TEST_F(Paths, OutsideOfTheDeclaredPlacesAreRefusedAndNothingIsTouched) {
  const auto link = (other_ / "line").string();

  EXPECT_EQ(set("gnss.core.device", "/etc/shadow"), "not_permitted");
  EXPECT_EQ(set("receiver.core.line", link), "not_permitted");
  EXPECT_EQ(set("map_server.core.file", "../map.yaml"), "not_permitted");
  const auto swapped = daemon_->ask({"swap-core", "gnss", "drivers/gnss_serial", "--set",
                                     "device=/etc/shadow", "--state", "drop"});

  EXPECT_NE(swapped.dump().find("not_permitted"), std::string::npos) << swapped;
  EXPECT_FALSE(fs::exists(fs::symlink_status(link)));
  EXPECT_EQ(daemon_->value("gnss.core.device"), "gnss.nmea") << "what the file says stays";
  EXPECT_EQ(daemon_->ask({"status"})["generation"], 1);
}

TEST_F(Paths, InTheDeclaredPlacesAreSet) {
  EXPECT_EQ(set("gnss.core.device", "pty:first"), "");
  EXPECT_EQ(set("receiver.core.line", "pty:second"), "");
  EXPECT_EQ(set("map_server.core.file", "other.yaml"), "");
  EXPECT_EQ(daemon_->value("gnss.core.device"), "pty:first");
}

TEST_F(Paths, NamingAFifoKeepNoHookWaiting) {
  for (int i = 0; i < 3; ++i) {
    EXPECT_NE(set("map_server.core.file", "pipe"), "");
  }

  const auto status = daemon_->ask({"status"});
  EXPECT_TRUE(status.value("abandoned_threads", json::array()).empty()) << status;
  EXPECT_EQ(set("map_server.core.file", "other.yaml"), "");
}

}  // namespace
}  // namespace mauve::test
