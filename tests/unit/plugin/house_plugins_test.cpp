// SPDX-License-Identifier: LGPL-3.0-or-later
/// Every plugin of plugins/ passes the checks, can be made use of, and can be unloaded.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "plugin/load/catalog.h"

namespace mauve::plugin::test {
namespace {

std::vector<std::string> house_plugins() {
  std::vector<std::string> names;
  for (const auto& file : std::filesystem::directory_iterator(MAUVE_PLUGINS)) {
    if (file.path().extension() == ".so") names.push_back(file.path().stem());
  }
  return names;
}

/// ROS has threads and exit handlers of its own: that plugin says that it stays mapped.
bool stays(const std::string& name) { return name == "ros"; }

void make_everything_once(const LoadedPlugin& plugin) {
  for (const auto& [name, core] : plugin.cores) EXPECT_NE(core.make(), nullptr) << name;
  for (const auto& [name, fsm] : plugin.fsms) EXPECT_NE(fsm.make(), nullptr) << name;
  for (const auto& [name, component] : plugin.components) {
    EXPECT_NE(component.shell.make(), nullptr) << name;
  }
  for (const auto& [name, resource] : plugin.resources) {
    EXPECT_NE(resource.shell.make(), nullptr) << name;
    EXPECT_NE(resource.interface(), nullptr) << name;
  }
  for (const auto& [name, type] : plugin.types) EXPECT_EQ(type->name, name);
}

TEST(HousePlugins, LoadTogetherAndLeaveNothingBehind) {
  const std::vector<std::string> names = house_plugins();
  ASSERT_FALSE(names.empty());
  Catalog catalog({MAUVE_PLUGINS});
  for (const std::string& name : names) {
    const Status loaded = catalog.load(name);
    ASSERT_TRUE(loaded) << to_string(loaded.error());
    const std::size_t expected = stays(name) ? 1 : 0;
    EXPECT_THAT(catalog.find(name)->info().warnings, ::testing::SizeIs(expected)) << name;
  }
  for (const std::string& name : names) make_everything_once(*catalog.find(name));

  for (const std::string& name : names) {
    const Result<Unmapped> unloaded = catalog.unload(name);
    ASSERT_TRUE(unloaded) << to_string(unloaded.error());
    EXPECT_EQ(unloaded->unmapped, !stays(name)) << name << ": " << unloaded->reason;
  }
}

}  // namespace
}  // namespace mauve::plugin::test
