// SPDX-License-Identifier: LGPL-3.0-or-later
// A reload is on probation: the build before stays in memory until the new one has proved itself.
#include "trial_daemon.h"

namespace mauve::test {
namespace {

using testing::HasSubstr;

const Json kTrialAgain = {{"plugin", "trial"}};

/// The build whose code `component` runs now.
[[nodiscard]] bool runs_build(TrialDaemon& daemon, const std::string& component, int build) {
  return daemon.becomes(component + ".core.number", build);
}

[[nodiscard]] bool logs(const TrialDaemon& daemon, const std::string& words) {
  return eventually([&] { return daemon.errors().find(words) != std::string::npos; });
}

/// "first" runs a core that throws in its first job where it is of build 2.
std::string with_regressing() {
  std::string text(kTrial);
  const std::string type = R"("first":  { "type": "trial/unit",)";
  return text.replace(text.find(type), type.size(), type + R"( "core": "trial/regressing",)");
}

TEST(ReloadOnProbation, LeadsAllMembersBackToTheBuildBeforeWhenTheNewOneFails) {
  TrialDaemon daemon(with_regressing());
  ASSERT_TRUE(runs_build(daemon, "first", 1)) << daemon.errors();
  daemon.install(2);

  const auto reloaded = daemon.ask("plugin.reload", kTrialAgain);

  EXPECT_EQ(reloaded["generation"], 2) << reloaded;
  ASSERT_TRUE(logs(daemon, "plugin trial is version")) << daemon.errors();
  EXPECT_EQ(daemon.ask("status.get")["generation"], 3);
  EXPECT_EQ(daemon.component("first")["state"], "running");
  EXPECT_TRUE(runs_build(daemon, "first", 1));
  EXPECT_TRUE(runs_build(daemon, "second", 1));
  EXPECT_TRUE(logs(daemon, "plugin trial unloaded: its reload was rolled back")) << daemon.errors();
  EXPECT_TRUE(logs(daemon, "Z warn    plugin trial is version ")) << daemon.errors();

  const auto again = daemon.ask("plugin.reload", kTrialAgain);
  EXPECT_THAT(again["message"].get<std::string>(), HasSubstr("trial/regressing is in quarantine"))
      << "the same build: " << again;
  const Json swap = {{"component", "second"}, {"core", "trial/other"}};
  EXPECT_EQ(daemon.ask("core.swap", swap)["state"], "applied");
  EXPECT_TRUE(runs_build(daemon, "second", 1)) << "names mean the build before again";
}

TEST(ReloadOnProbation, KeepsOneBuildBeforeUntilItIsConfirmed) {
  TrialDaemon daemon;
  static_cast<void>(daemon.client());
  daemon.install(2);

  const auto reloaded = daemon.ask("plugin.reload", kTrialAgain);
  EXPECT_EQ(reloaded["unmapped"], false) << reloaded;
  EXPECT_THAT(reloaded["why"].get<std::string>(),
              HasSubstr("until the probation of generation 2 ends"));
  EXPECT_TRUE(reloaded.contains("probation")) << reloaded;
  daemon.install(1);
  const auto refused = daemon.ask("plugin.reload", kTrialAgain);
  EXPECT_EQ(refused["data"]["name"], "conflict") << refused;
  EXPECT_THAT(refused["data"]["hint"].get<std::string>(), HasSubstr("mauvectl confirm"));
  EXPECT_TRUE(runs_build(daemon, "first", 2));

  ASSERT_EQ(daemon.ask("change.confirm")["changed"], true);
  EXPECT_TRUE(logs(daemon, "unloaded: replaced by a new one, which has proved itself"))
      << daemon.errors();
  EXPECT_EQ(daemon.ask("plugin.reload", kTrialAgain)["state"], "applied");
  EXPECT_TRUE(runs_build(daemon, "first", 1));
}

TEST(ReloadOnProbation, IsUndoneWithTheChangesThatJoinedIt) {
  TrialDaemon daemon;
  static_cast<void>(daemon.client());
  daemon.install(2);
  ASSERT_EQ(daemon.ask("plugin.reload", kTrialAgain)["state"], "applied");
  ASSERT_EQ(daemon.ask("param.set", {{"values", {{"first.core.gain", 3.0}}}})["state"], "applied");
  ASSERT_TRUE(runs_build(daemon, "first", 2));

  ASSERT_EQ(daemon.ask("change.undo")["state"], "applied");

  EXPECT_TRUE(runs_build(daemon, "first", 1));
  EXPECT_TRUE(runs_build(daemon, "second", 1));
  EXPECT_EQ(daemon.value("first.core.gain"), 1.0);
  EXPECT_TRUE(logs(daemon, "unloaded: its reload was rolled back")) << daemon.errors();
  EXPECT_EQ(daemon.ask("plugin.reload", kTrialAgain)["state"], "applied") << "nothing failed";
}

TEST(ReloadOnProbation, LeavesNoCodeBehindWhereACoreStoodBy) {
  std::string text(kTrial);
  const std::string first = R"("first":  { "type": "trial/unit", )";
  ASSERT_NE(text.find(first), std::string::npos);
  TrialDaemon daemon(text.replace(text.find(first), first.size(), first + R"(
      "task": { "on_fault": "fallback" }, "fallback_core": "trial/other", )"));
  static_cast<void>(daemon.client());
  daemon.install(2);
  ASSERT_EQ(daemon.ask("plugin.reload", kTrialAgain)["state"], "applied");
  EXPECT_TRUE(logs(daemon, "the older code of plugin trial stays in memory")) << daemon.errors();

  ASSERT_EQ(daemon.ask("change.undo")["state"], "applied");

  EXPECT_TRUE(logs(daemon, "unloaded: its reload was rolled back")) << daemon.errors();
}

TEST(ReloadOnProbation, LeadsResourcesBackToo) {
  std::string text(kTrial);
  const std::string resources = R"("resources": {)";
  text.insert(text.find(resources) + resources.size(),
              R"( "tally": { "type": "trial/tally", "lock_budget": "1ms" },)");
  const std::string output = R"("output": "signal.write")";
  TrialDaemon daemon(text.replace(text.find(output), output.size(), R"("output": "tally.note")"));
  ASSERT_TRUE(eventually([&] { return daemon.value("tally.core.count") > 50; })) << daemon.errors();
  daemon.install(2);
  ASSERT_EQ(daemon.ask("plugin.reload", kTrialAgain)["state"], "applied");
  ASSERT_TRUE(runs_build(daemon, "tally", 2));

  ASSERT_EQ(daemon.ask("change.undo")["state"], "applied");

  EXPECT_TRUE(runs_build(daemon, "tally", 1));
  EXPECT_TRUE(runs_build(daemon, "first", 1));
  EXPECT_GT(daemon.value("tally.core.count"), 50);
  EXPECT_TRUE(logs(daemon, "unloaded: its reload was rolled back")) << daemon.errors();
}

TEST(ReloadOnProbation, IsShownByADryRunThatChangesNothing) {
  TrialDaemon daemon;
  static_cast<void>(daemon.client());
  daemon.install(2);

  auto params = kTrialAgain;
  params["dry_run"] = true;
  const auto planned = daemon.ask("plugin.reload", params);

  EXPECT_EQ(planned["dry_run"], true) << planned;
  EXPECT_EQ(planned["lines"][0]["kind"], "plugin") << planned;
  EXPECT_EQ(planned["components"].size(), 2U) << planned;
  EXPECT_EQ(daemon.ask("status.get")["generation"], 1);
  EXPECT_EQ(daemon.value("first.core.number"), 1);
  EXPECT_EQ(daemon.ask("plugin.reload", kTrialAgain)["state"], "applied");
}

}  // namespace
}  // namespace mauve::test
