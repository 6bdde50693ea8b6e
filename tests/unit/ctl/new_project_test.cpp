// SPDX-License-Identifier: LGPL-3.0-or-later
// The files that `mauvectl new` writes, and the names that it refuses. tests/external builds the
// projects.
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/temp_dir.h"
#include "unit/ctl/scene.h"

namespace mauve::ctl {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

/// Runs in an empty folder.
class NewProject : public testing::Test {
 public:
  NewProject() { fs::current_path(folder_.path()); }
  ~NewProject() override { fs::current_path(before_); }

  static Outcome write(const std::string& kind, const std::string& name) {
    return run("/nowhere", {"new", kind, name});
  }

 private:
  fs::path before_ = fs::current_path();
  test::TempDir folder_;
};

TEST_F(NewProject, HasTheNameInPlaceOfThatOfTheExample) {
  const std::vector<std::pair<std::string, std::string>> kinds = {{"core", "homing"},
                                                                  {"component", "tracker"},
                                                                  {"resource", "water_tank"},
                                                                  {"driver", "serial_heater"}};
  for (const auto& [kind, example] : kinds) {
    const std::string name = "my_" + kind;
    const Outcome outcome = write(kind, name);
    EXPECT_EQ(outcome.exit, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("cd " + name + "\n"));
    EXPECT_THAT(outcome.out, testing::ContainsRegex("  mauved [^\n]*--plugin-dir build"));
    EXPECT_THAT(test::TempDir::read(name + "/CMakeLists.txt"),
                HasSubstr("mauve_add_plugin(" + name + " SOURCES"));
    EXPECT_TRUE(fs::exists(name + "/" + name + "_test.cpp")) << kind;
    if (kind != "core") {  // a core runs in the robot of yard.json
      EXPECT_THAT(test::TempDir::read(name + "/architecture.json"),
                  HasSubstr("\"name\": \"" + name + "\""));
    }
    for (const auto& file : fs::directory_iterator(name)) {
      EXPECT_THAT(file.path().string(), Not(HasSubstr(example)));
      EXPECT_THAT(test::TempDir::read(file), Not(HasSubstr(example))) << file.path();
    }
  }
}

TEST_F(NewProject, RefusesANameThatIsNone) {
  for (const std::string name : {"My_core", "9lives", "my-core", "my__core", "core_", "a/b", "..",
                                 "class", "test", "mauve"}) {
    const Outcome outcome = write("core", name);
    EXPECT_EQ(outcome.exit, 1) << name;
    EXPECT_THAT(outcome.err, HasSubstr("hint")) << name;
  }
  EXPECT_TRUE(fs::is_empty(fs::current_path()));
  EXPECT_THAT(write("core", "class").err, HasSubstr("such as my_class"));
}

TEST_F(NewProject, LeavesAFolderThatIsThereAlone) {
  fs::create_directory("mine");
  const Outcome outcome = write("component", "mine");
  EXPECT_EQ(outcome.exit, 1);
  EXPECT_THAT(outcome.err, HasSubstr("there is a file or folder of this name already"));
  EXPECT_TRUE(fs::is_empty("mine"));
}

TEST_F(NewProject, PrintsTheNextCommandsAsJsonToo) {
  const auto outcome = run("/nowhere", {"--json", "new", "driver", "sonar"});
  const Json answer = Json::parse(outcome.out, nullptr, false);
  ASSERT_TRUE(answer.is_object()) << outcome.out;
  EXPECT_EQ(answer["folder"], "sonar");
  EXPECT_EQ(answer["next"][0], "cd sonar");
}

}  // namespace
}  // namespace mauve::ctl
