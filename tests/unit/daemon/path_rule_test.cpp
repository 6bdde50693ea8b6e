// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/path_rule.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "mauve/shell.h"
#include "support/temp_dir.h"

namespace mauve::daemon {
namespace {

namespace fs = std::filesystem;
using test::TempDir;

struct PathShell : Shell {
  Property<std::string> device{*this, "device", "", "a device or a name", {.within = "/dev/ pty:"}};
  Property<std::string> map{*this, "map", "", "a file", {.within = "./"}};
  Property<std::string> note{*this, "note", "", "is no path"};
  Property<double> gain{*this, "gain", 1.0};
};

/// In a folder of the test, as mauved is in that of its architecture.
class PathRule : public testing::Test {
 protected:
  void SetUp() override {
    before_ = fs::current_path();
    fs::current_path(folder_.path());
  }
  void TearDown() override { fs::current_path(before_); }

  [[nodiscard]] bool device(const std::string& path) const {
    return lies_within(shell_.device, path, more_).has_value();
  }
  [[nodiscard]] bool map(const std::string& path) const {
    return lies_within(shell_.map, path, more_).has_value();
  }

  // Not where the other folders of tests may be: below /dev no path is allowed that leads to files.
  TempDir folder_{"/tmp"};
  TempDir other_{"/tmp"};
  fs::path before_;
  PathShell shell_;
  std::vector<std::string> more_;
};

TEST_F(PathRule, AllowsWhatLiesWhereThePropertySays) {
  EXPECT_TRUE(device("/dev/null"));
  EXPECT_TRUE(device("/dev/ttyUSB99")) << "not plugged in yet";
  EXPECT_TRUE(device("pty:gnss"));
  EXPECT_TRUE(device("")) << "none";
  EXPECT_TRUE(map("map.yaml"));
  EXPECT_TRUE(map("maps/../map.yaml"));
  EXPECT_TRUE(map((folder_ / "maps/map.yaml").string()));
}

TEST_F(PathRule, RefusesWhatLiesElsewhereAndSaysWhatIsAllowed) {
  for (const char* path : {"/etc/shadow", "/device", "/dev", "/dev/", "/dev/../etc/shadow",
                           "ttyUSB0", "pty:../../etc/x", "pty:x/../y", "/dev/stdin/../../x"}) {
    EXPECT_FALSE(device(path)) << path;
  }
  for (const char* path : {"/etc/passwd", "../map.yaml", ".", "./", "maps/../../map.yaml"}) {
    EXPECT_FALSE(map(path)) << path;
  }
  const auto refused = lies_within(shell_.device, "/etc/shadow", {"/srv/lines"});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, Errc::not_permitted);
  EXPECT_THAT(refused.error().at, testing::HasSubstr("device"));
  EXPECT_EQ(refused.error().message, "'/etc/shadow' is outside of /dev/ or pty: or /srv/lines");
  EXPECT_THAT(refused.error().hint, testing::HasSubstr("--allow-path"));
}

TEST_F(PathRule, RefusesPlacesBelowDevInWhichEverybodyMayExchangeFiles) {
  EXPECT_FALSE(device("/dev/shm/line"));
  EXPECT_FALSE(device("/dev/mqueue/line"));
  EXPECT_FALSE(device("/dev/../dev/shm/a/line"));
  EXPECT_TRUE(device("/dev/shmoo"));
  const auto refused = lies_within(shell_.device, "/dev/shm/line", {});
  EXPECT_THAT(refused.error().message, testing::HasSubstr("exchange a file for a link"));

  more_ = {"/dev/shm"};
  EXPECT_TRUE(device("/dev/shm/line")) << "who starts mauved may say so";
}

TEST_F(PathRule, FollowsSymbolicLinks) {
  fs::create_directory(folder_ / "maps");
  fs::create_symlink(folder_ / "maps", folder_ / "near");
  fs::create_symlink(other_.path(), folder_ / "far");
  fs::create_symlink("/dev/null", folder_ / "line");

  EXPECT_TRUE(map("near/map.yaml"));
  EXPECT_FALSE(map("far/map.yaml"));
  EXPECT_TRUE(device((folder_ / "line").string())) << "as links of /dev/serial lead into /dev";
}

TEST_F(PathRule, AllowsTheDirectoriesOfTheOptionToo) {
  const auto file = (other_ / "recording").string();
  EXPECT_FALSE(device(file));

  more_ = {other_.path().string()};

  EXPECT_TRUE(device(file));
  EXPECT_TRUE(map(file));
  EXPECT_FALSE(device(other_.path().string() + "x/recording"));
}

TEST_F(PathRule, LeavesOtherPropertiesAlone) {
  EXPECT_TRUE(lies_within(shell_.note, "/etc/shadow", {}));
  EXPECT_TRUE(lies_within(shell_.gain, 2.0, {}));
  EXPECT_TRUE(lies_within(shell_.device, 2.0, {})) << "the property itself refuses it";
}

}  // namespace
}  // namespace mauve::daemon
