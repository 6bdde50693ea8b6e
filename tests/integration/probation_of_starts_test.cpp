// SPDX-License-Identifier: LGPL-3.0-or-later
// A change that starts or stops a component and changes something else of it is on probation.
#include "trial_daemon.h"

namespace mauve::test {
namespace {

/// Changes of a component that stands, which start it or leave it stopped.
const std::vector<std::string> kStartsWithMore = {
    R"([{"set": "first.core.gain", "value": 3.0}, {"start": "first"}])",
    R"([{"disconnect": "first.ports.output"}, {"start": "first"}])",
    R"([{"set": "first.fsm.period", "value": "3ms"}, {"start": "first"}])",
    R"([{"swap": "first", "core": "trial/other"}, {"start": "first"}])",
    R"([{"set": "second.core.gain", "value": 3.0}, {"stop": "second"}])"};

TEST(ProbationOfStarts, IsKeptByAChangeThatStartsOrStopsWhatItChanges) {
  for (const auto& steps : kStartsWithMore) {
    TrialDaemon daemon;
    const auto before = daemon.ask("config.get")["architecture"];
    ASSERT_EQ(daemon.ask("component.stop", {{"components", {"first"}}})["state"], "applied");

    const auto receipt = daemon.ask("change.apply", {{"text", steps}, {"confirm_within", "1h"}});

    ASSERT_EQ(receipt["state"], "applied") << receipt;
    EXPECT_GT(receipt["probation"].value("confirm_within_ns", 0LL), 0) << receipt;
    EXPECT_EQ(daemon.ask("status.get")["probations"].size(), 1U) << steps;
    ASSERT_EQ(daemon.ask("change.undo")["state"], "applied") << steps;
    const auto after = daemon.ask("config.get")["architecture"];
    EXPECT_EQ(after["components"]["first"]["properties"],
              before["components"]["first"]["properties"]);
    EXPECT_EQ(after["components"]["first"]["ports"], before["components"]["first"]["ports"]);
  }
}

TEST(ProbationOfStarts, IsKeptByAFileThatStopsWhatItChanges) {
  TrialDaemon daemon;
  auto file = daemon.ask("config.get")["architecture"];
  file["components"]["first"]["start"] = false;
  file["components"]["first"]["properties"]["core.gain"] = 3.0;

  const auto receipt =
      daemon.ask("architecture.apply", {{"text", file.dump()}, {"confirm_within", "1h"}});

  ASSERT_EQ(receipt["state"], "applied") << receipt;
  EXPECT_EQ(daemon.ask("status.get")["probations"].size(), 1U) << receipt;
  ASSERT_EQ(daemon.ask("change.undo")["state"], "applied");
  EXPECT_EQ(daemon.value("first.core.gain"), 1.0);
}

TEST(ProbationOfStarts, IsRefusedForAChangeThatOnlyStartsAndNeverForAStop) {
  TrialDaemon daemon;
  const Json stop = {{"text", R"([{"stop": "first"}])"}, {"confirm_within", "1h"}};
  ASSERT_EQ(daemon.ask("change.apply", stop)["state"], "applied") << "the way to safe values";
  const Json start = {{"text", R"([{"start": "first"}])"}, {"confirm_within", "1h"}};

  const auto refused = daemon.ask("change.apply", start);

  EXPECT_EQ(refused["data"]["id"], "nothing_to_try") << refused;
  EXPECT_EQ(refused["data"]["state"], "unchanged");
  EXPECT_EQ(daemon.component("first")["state"], "stopped");
}

TEST(ProbationOfStarts, IsRefusedForAReloadOfAPluginThatNothingUses) {
  TrialDaemon daemon;
  std::filesystem::copy_file(std::filesystem::path(MAUVE_PLUGIN_DIR) / "types.so",
                             daemon.plugins() / "types.so");
  ASSERT_EQ(daemon.ask("plugin.load", {{"plugin", "types"}})["loaded"], true);
  const Json reload = {{"plugin", "types"}, {"confirm_within", "1h"}};

  const auto refused = daemon.ask("plugin.reload", reload);

  EXPECT_EQ(refused["data"]["id"], "nothing_to_try") << refused;
  EXPECT_EQ(refused["data"]["state"], "unchanged");
  EXPECT_EQ(daemon.ask("plugin.reload", {{"plugin", "types"}})["state"], "applied");
}

}  // namespace
}  // namespace mauve::test
