// SPDX-License-Identifier: LGPL-3.0-or-later
// A swap in place is on probation: the core before takes over again where the new one fails.
#include "trial_daemon.h"

namespace mauve::test {
namespace {

using testing::HasSubstr;

Json place_swap(const std::string& core, const Json& more = Json::object()) {
  Json params = {{"component", "first"}, {"core", core}, {"in_place", true}};
  params.update(more);
  return params;
}

[[nodiscard]] bool has_core(TrialDaemon& daemon, const std::string& core) {
  return eventually([&] {
    const auto row = daemon.component("first");
    return row["core"] == core && row["state"] == "running";
  });
}

/// Without a probation, so nothing replaces the core that failed.
void make_first_faulted(TrialDaemon& daemon) {
  static_cast<void>(daemon.client());
  const Json swap = {{"component", "first"}, {"core", "trial/throwing_job"}, {"probation", "off"}};
  ASSERT_EQ(daemon.ask("core.swap", swap)["state"], "applied");
  ASSERT_TRUE(eventually([&] { return daemon.component("first")["state"] == "faulted"; }));
}

TEST(PlaceProbation, RollsBackToTheCoreBeforeWhenTheNewOneFails) {
  TrialDaemon daemon;
  static_cast<void>(daemon.client());

  const auto swapped = daemon.ask("core.swap", place_swap("trial/throwing_job"));

  EXPECT_EQ(swapped["generation"], 2) << swapped;
  EXPECT_TRUE(swapped.contains("probation")) << swapped;
  ASSERT_TRUE(has_core(daemon, "trial/steady")) << daemon.errors();
  EXPECT_EQ(daemon.ask("status.get")["generation"], 3);
  const auto core = daemon.ask("quarantine.list")["cores"][0];
  EXPECT_EQ(core["core"], "trial/throwing_job");
  EXPECT_EQ(core["reason"], "threw: division by something");
  EXPECT_TRUE(daemon.ask("status.get")["probations"].empty());
  const auto why = daemon.ask("component.why", {{"component", "first"}});
  EXPECT_THAT(why.dump(), HasSubstr("rolled_back")) << why;
}

TEST(PlaceProbation, IsShownConfirmedAndUndone) {
  TrialDaemon daemon;
  static_cast<void>(daemon.client());
  ASSERT_EQ(daemon.ask("core.swap", place_swap("trial/other"))["state"], "applied");

  const auto open = daemon.ask("status.get")["probations"];
  ASSERT_EQ(open.size(), 1U);
  EXPECT_EQ(open[0]["components"], Json::array({"first"}));
  EXPECT_EQ(open[0]["state"], "watching");
  const auto undone = daemon.ask("change.undo");
  EXPECT_EQ(undone["state"], "applied") << undone;
  EXPECT_TRUE(has_core(daemon, "trial/steady")) << daemon.errors();

  ASSERT_EQ(daemon.ask("core.swap", place_swap("trial/other"))["state"], "applied");
  EXPECT_EQ(daemon.ask("change.confirm")["changed"], true);
  EXPECT_TRUE(daemon.ask("status.get")["probations"].empty());
  EXPECT_TRUE(has_core(daemon, "trial/other"));
}

/// Whether the undo or the look of [health] comes first, the core that failed is in quarantine.
TEST(PlaceProbation, IsARollbackByItsFailureAlsoWhenAUserAsksForItsUndo) {
  for (int i = 0; i < 5; ++i) {
    TrialDaemon daemon;
    static_cast<void>(daemon.client());
    ASSERT_EQ(daemon.ask("core.swap", place_swap("trial/throwing_job"))["state"], "applied");
    ASSERT_TRUE(eventually([&] {
      const auto row = daemon.component("first");
      return row["state"] != "running" || row["core"] == "trial/steady";
    })) << "its core fails in its first job";

    const auto undone = daemon.ask("change.undo");

    const bool came_first = undone.value("state", "") == "applied";
    EXPECT_TRUE(came_first || undone["data"]["id"] == "nothing_to_undo") << undone;
    ASSERT_TRUE(has_core(daemon, "trial/steady")) << daemon.errors();
    const auto cores = daemon.ask("quarantine.list")["cores"];
    ASSERT_EQ(cores.size(), 1U) << daemon.errors();
    EXPECT_EQ(cores[0]["core"], "trial/throwing_job");
  }
}

TEST(PlaceProbation, GoesBackUnlessItIsConfirmedInItsTime) {
  TrialDaemon daemon;
  static_cast<void>(daemon.client());

  ASSERT_EQ(
      daemon.ask("core.swap", place_swap("trial/other", {{"confirm_within", "50ms"}}))["state"],
      "applied");

  EXPECT_TRUE(has_core(daemon, "trial/steady")) << daemon.errors();
  EXPECT_TRUE(daemon.ask("quarantine.list")["cores"].empty()) << "nothing failed";
}

TEST(PlaceProbation, EndsEarlyByAChangeOfItsComponentWhichSaysSo) {
  TrialDaemon daemon;
  static_cast<void>(daemon.client());
  ASSERT_EQ(daemon.ask("core.swap", place_swap("trial/other"))["state"], "applied");

  const auto elsewhere = daemon.ask("param.set", {{"values", {{"second.core.gain", 2.0}}}});
  EXPECT_FALSE(elsewhere.contains("notes")) << elsewhere;
  const auto set = daemon.ask("param.set", {{"values", {{"first.core.gain", 2.0}}}});

  ASSERT_EQ(set["notes"].size(), 1U) << set;
  EXPECT_THAT(set["notes"][0].get<std::string>(),
              HasSubstr("generation 2 (first, swapped in place)"));
  EXPECT_TRUE(eventually([&] { return daemon.ask("status.get")["probations"].size() == 2U; }))
      << "those of the two sets: " << daemon.ask("status.get")["probations"];
}

TEST(PlaceProbation, LeavesAComponentStoppedThatWasStoppedMeanwhile) {
  TrialDaemon daemon;
  static_cast<void>(daemon.client());
  ASSERT_EQ(daemon.ask("core.swap", place_swap("trial/other"))["state"], "applied");
  ASSERT_EQ(daemon.ask("component.stop", {{"components", {"first"}}})["state"], "applied");

  ASSERT_EQ(daemon.ask("change.undo")["state"], "applied");

  EXPECT_EQ(daemon.component("first")["core"], "trial/steady");
  EXPECT_EQ(daemon.component("first")["state"], "stopped");
}

// The change campaign: a sound core was in quarantine for the exception of the core before it.
TEST(PlaceProbation, DoesNotBlameTheNewCoreForTheFailureOfTheCoreBefore) {
  TrialDaemon daemon;
  ASSERT_NO_FATAL_FAILURE(make_first_faulted(daemon));

  const Json unconfirmed = place_swap("trial/other", {{"confirm_within", "50ms"}});
  ASSERT_EQ(daemon.ask("core.swap", unconfirmed)["state"], "applied");
  EXPECT_TRUE(eventually([&] { return daemon.ask("status.get")["probations"].empty(); }));
  EXPECT_TRUE(daemon.ask("quarantine.list")["cores"].empty()) << daemon.errors();
  EXPECT_EQ(daemon.component("first")["state"], "faulted") << "nobody started it";

  const Json proved = place_swap("trial/other", {{"probation", "2"}});
  ASSERT_EQ(daemon.ask("core.swap", proved)["state"], "applied");
  ASSERT_EQ(daemon.ask("component.start", {{"components", {"first"}}})["state"], "applied");
  EXPECT_TRUE(eventually([&] { return daemon.ask("status.get")["probations"].empty(); }));
  EXPECT_TRUE(has_core(daemon, "trial/other")) << daemon.errors();
  EXPECT_TRUE(daemon.ask("quarantine.list")["cores"].empty()) << daemon.errors();
}

TEST(PlaceProbation, UndoneLeavesAComponentFaultedThatWasFaultedBefore) {
  TrialDaemon daemon;
  ASSERT_NO_FATAL_FAILURE(make_first_faulted(daemon));
  const auto releases = daemon.component("first")["releases"];
  ASSERT_EQ(daemon.ask("core.swap", place_swap("trial/other"))["state"], "applied");

  ASSERT_EQ(daemon.ask("change.undo")["state"], "applied");

  EXPECT_EQ(daemon.component("first")["core"], "trial/throwing_job");
  EXPECT_EQ(daemon.component("first")["state"], "faulted");
  EXPECT_EQ(daemon.component("first")["releases"], releases) << "its core did not run again";
}

TEST(PlaceProbation, DoesNotStartAComponentThatWasStoppedAfterItsNewCoreFailed) {
  TrialDaemon daemon;
  auto client = daemon.client();
  const auto fails = daemon.place() / "fails";
  const auto configures = daemon.place() / "configures";
  ASSERT_EQ(
      daemon.ask("core.swap", place_swap("trial/brittle",
                                         {{"set", {{"until_there", fails.string()}}}}))["state"],
      "applied");

  // While another change is being prepared, nothing rolls back yet.
  static_cast<void>(client.send(
      protocol::to_line(protocol::make_request(1, "core.swap",
                                               {{"component", "second"},
                                                {"core", "trial/slow"},
                                                {"set", {{"marker", configures.string()}}}})) +
      '\n'));
  ASSERT_TRUE(eventually([&] { return std::filesystem::exists(configures); }));
  std::ofstream(fails) << "now";
  ASSERT_TRUE(eventually([&] { return daemon.component("first")["state"] == "faulted"; }));
  ASSERT_TRUE(daemon.ask("component.stop", {{"components", {"first"}}}).contains("state"));

  EXPECT_TRUE(eventually([&] { return daemon.component("first")["core"] == "trial/steady"; }));
  EXPECT_NE(daemon.component("first")["state"], "running") << daemon.errors();
  EXPECT_EQ(daemon.ask("quarantine.list")["cores"][0]["core"], "trial/brittle");
}

/// Begins the swap of `second`, and returns while its new core is configured.
[[nodiscard]] bool begin_slow_swap(TrialDaemon& daemon, RawClient& client, Json more) {
  const auto configures = daemon.place() / "configures";
  Json params = {
      {"component", "second"}, {"core", "trial/slow"}, {"set", {{"marker", configures.string()}}}};
  params.update(more);
  return client.send(protocol::to_line(protocol::make_request(1, "core.swap", params)) + '\n') &&
         eventually([&] { return std::filesystem::exists(configures); });
}

/// The change under way may be one whose answer its user has: what it retired is freed after that.
TEST(PlaceProbation, IsUndoneWhenTheChangeUnderWayHasEnded) {
  TrialDaemon daemon;
  auto client = daemon.client();
  ASSERT_EQ(daemon.ask("core.swap", place_swap("trial/other"))["state"], "applied");
  ASSERT_TRUE(begin_slow_swap(daemon, client, {{"probation", "off"}}));

  const auto undone = daemon.ask("change.undo");

  EXPECT_EQ(undone["state"], "applied") << undone;
  EXPECT_EQ(daemon.component("first")["core"], "trial/steady");
  EXPECT_EQ(client.json()["result"]["state"], "applied");
  EXPECT_EQ(daemon.component("second")["core"], "trial/slow");
}

TEST(PlaceProbation, IsNotUndoneWhenAnotherChangeBecomesTheNewestMeanwhile) {
  TrialDaemon daemon;
  auto client = daemon.client();
  ASSERT_EQ(daemon.ask("core.swap", place_swap("trial/other"))["state"], "applied");
  ASSERT_TRUE(begin_slow_swap(daemon, client, Json::object()));

  const auto refused = daemon.ask("change.undo");

  EXPECT_EQ(refused["data"]["name"], "conflict") << refused;
  EXPECT_THAT(refused["message"].get<std::string>(),
              HasSubstr("generation 3 is the newest change on probation now"));
  EXPECT_EQ(daemon.component("first")["core"], "trial/other");
  EXPECT_EQ(daemon.component("second")["core"], "trial/slow");
}

TEST(PlaceProbation, HoldsAlsoForAComponentThatWasStoppedDuringTheSwap) {
  TrialDaemon daemon;
  auto client = daemon.client();
  const auto configures = daemon.place() / "configures";
  static_cast<void>(client.send(
      protocol::to_line(protocol::make_request(
          1, "core.swap", place_swap("trial/slow", {{"set", {{"marker", configures.string()}}}}))) +
      '\n'));
  ASSERT_TRUE(eventually([&] { return std::filesystem::exists(configures); }));
  ASSERT_TRUE(daemon.ask("component.stop", {{"components", {"first"}}}).contains("state"));

  EXPECT_EQ(client.json()["result"]["state"], "applied");
  EXPECT_EQ(daemon.component("first")["core"], "trial/slow");
  EXPECT_EQ(daemon.component("first")["state"], "stopped");
  EXPECT_EQ(daemon.ask("status.get")["probations"].size(), 1U);
  EXPECT_EQ(daemon.ask("change.undo")["state"], "applied");
  EXPECT_EQ(daemon.component("first")["core"], "trial/steady");
  EXPECT_EQ(daemon.component("first")["state"], "stopped");
}

}  // namespace
}  // namespace mauve::test
