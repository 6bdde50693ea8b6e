// SPDX-License-Identifier: LGPL-3.0-or-later
// Plugins that go while the daemon runs, or that something still needs.
#include "trial_daemon.h"

namespace mauve::test {
namespace {

using testing::HasSubstr;

TEST(Unload, UnmapsAPluginThatNothingUses) {
  TrialDaemon daemon(R"({ "schema": "mauve/architecture/1", "name": "empty", "components": {} })");
  ASSERT_EQ(daemon.ask("plugin.load", {{"plugin", "trial"}})["loaded"], true);

  const auto unloaded = daemon.ask("plugin.unload", {{"plugin", "trial"}});

  EXPECT_EQ(unloaded["unmapped"], true) << unloaded;
  EXPECT_EQ(daemon.ask("plugin.list")["items"].size(), 0U);
}

TEST(Unload, SaysThatAPluginIsOnlyKeptForARollback) {
  TrialDaemon daemon;
  const std::string empty =
      R"({ "schema": "mauve/architecture/1", "name": "trial", "plugins": ["trial"] })";
  ASSERT_EQ(daemon.ask("architecture.apply", {{"text", empty}})["state"], "applied");

  const auto error = daemon.ask("plugin.unload", {{"plugin", "trial"}});

  EXPECT_THAT(error["message"].get<std::string>(),
              HasSubstr("kept for the rollback until generation 2"));
  EXPECT_EQ(error["data"]["hint"], "mauvectl confirm ends that at once");
  ASSERT_EQ(daemon.ask("change.confirm")["changed"], true);
  EXPECT_TRUE(eventually([&] {
    return daemon.ask("plugin.unload", {{"plugin", "trial"}}).contains("unmapped");
  }));
}

TEST(Unload, NamesTheUsersOfAPluginInUse) {
  TrialDaemon daemon;

  const auto error = daemon.ask("plugin.unload", {{"plugin", "trial"}});

  EXPECT_THAT(error["message"].get<std::string>(), HasSubstr("first.core"));
}

}  // namespace
}  // namespace mauve::test
