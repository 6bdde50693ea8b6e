// SPDX-License-Identifier: LGPL-3.0-or-later
// Changes on probation: rolled back by themselves, undone, confirmed.
#include "mauve/host/probation.h"
#include "trial_daemon.h"

namespace mauve::test {
namespace {

using testing::HasSubstr;

Json swap_to(const std::string& core, Json more = Json::object()) {
  Json params = {{"component", "first"}, {"core", core}};
  params.update(more);
  return params;
}

bool runs(TrialDaemon& daemon, const std::string& core) {
  return eventually([&] {
    const auto first = daemon.component("first");
    return first["core"] == core && first["state"] == "running";
  });
}

TEST(Probation, ABadCoreIsRolledBackAndItsBuildQuarantined) {
  TrialDaemon daemon;
  const auto receipt = daemon.ask("core.swap", swap_to("trial/throwing_job"));
  ASSERT_EQ(receipt["state"], "applied") << receipt;
  EXPECT_EQ(receipt["probation"]["activations"], 3000);

  EXPECT_TRUE(eventually([&] { return daemon.ask("status.get")["generation"] == 3; }));
  EXPECT_TRUE(runs(daemon, "trial/steady"));

  ASSERT_TRUE(eventually([&] { return daemon.ask("quarantine.list")["cores"].size() == 1U; }));
  const auto quarantine = daemon.ask("quarantine.list");
  EXPECT_EQ(quarantine["cores"][0]["core"], "trial/throwing_job");
  EXPECT_EQ(quarantine["cores"][0]["reason"], "threw: division by something");
  const auto again = daemon.ask("core.swap", swap_to("trial/throwing_job"));
  EXPECT_EQ(again["data"]["name"], "wrong_state") << again;
  EXPECT_THAT(again["message"].get<std::string>(), HasSubstr("quarantine"));
}

TEST(Probation, OnlyTheCoreThatFailedIsQuarantined) {
  TrialDaemon daemon;
  auto file = daemon.ask("config.get")["architecture"];
  file["components"]["first"]["core"] = "trial/throwing_job";
  file["components"]["second"]["core"] = "trial/other";
  file["components"]["third"] = file["components"]["second"];
  file["components"]["third"]["core"] = "trial/counting";
  // A busy machine may make the others late; that shall not count here.
  const auto applied =
      daemon.ask("architecture.apply", {{"text", file.dump()}, {"misses", "63/64"}});
  ASSERT_EQ(applied["state"], "applied") << applied;

  ASSERT_TRUE(eventually([&] { return !daemon.ask("quarantine.list")["cores"].empty(); }));

  const auto quarantine = daemon.ask("quarantine.list")["cores"];
  ASSERT_EQ(quarantine.size(), 1U) << quarantine;
  EXPECT_EQ(quarantine[0]["core"], "trial/throwing_job");
  EXPECT_EQ(daemon.ask("core.swap", swap_to("trial/other"))["state"], "applied");
}

TEST(Probation, ToleratesAsManyLateJobsAsTheRequestSays) {
  TrialDaemon daemon;

  EXPECT_EQ(daemon.ask("core.swap", swap_to("trial/other", {{"misses", "2/64"}}))["state"],
            "applied");

  for (const char* wrong : {"2", "2/", "/64", "3/65", "4/4", "-1/8", "2/64x", "", "0/64"}) {
    const auto refused = daemon.ask("core.swap", swap_to("trial/steady", {{"misses", wrong}}));
    EXPECT_EQ(refused["data"]["where"], "misses") << wrong << refused;
    EXPECT_EQ(refused["data"]["state"], "unchanged");
  }
}

TEST(Probation, AReleasedCoreMayBeTriedAgain) {
  TrialDaemon daemon;
  ASSERT_EQ(daemon.ask("core.swap", swap_to("trial/throwing_job"))["state"], "applied");
  ASSERT_TRUE(eventually([&] { return daemon.ask("quarantine.list")["cores"].size() == 1U; }));

  EXPECT_EQ(daemon.ask("quarantine.release", {{"core", "trial/other"}})["data"]["name"],
            "unknown_name");
  EXPECT_EQ(daemon.ask("quarantine.release", {{"core", "trial/throwing_job"}})["changed"], true);

  EXPECT_EQ(daemon.ask("core.swap", swap_to("trial/throwing_job"))["state"], "applied");
  EXPECT_TRUE(eventually([&] { return daemon.ask("status.get")["generation"] == 5; }));
  EXPECT_TRUE(runs(daemon, "trial/steady"));
}

TEST(Probation, UndoAnswersWhenEverythingIsBack) {
  TrialDaemon daemon;
  ASSERT_EQ(daemon.ask("core.swap", swap_to("trial/other"))["state"], "applied");

  const auto undone = daemon.ask("change.undo");

  EXPECT_EQ(undone["generation"], 3) << undone;
  EXPECT_TRUE(runs(daemon, "trial/steady"));
  EXPECT_EQ(daemon.ask("quarantine.list")["cores"].size(), 0U) << "nobody was at fault";
  const auto again = daemon.ask("change.undo");
  EXPECT_EQ(again["data"]["name"], "wrong_state");
  EXPECT_THAT(again["message"].get<std::string>(), HasSubstr("no change is on probation"));
  EXPECT_EQ(again["data"].value("hint", ""), "mauvectl logs shows the changes");
}

TEST(Probation, UndoOfAChangeThatIsKeptNamesTheOldValue) {
  TrialDaemon daemon;
  const Json change = {{"values", {{"first.core.gain", 3.0}}}, {"probation", "off"}};
  ASSERT_EQ(daemon.ask("param.set", change)["state"], "applied");

  const auto refused = daemon.ask("change.undo");

  EXPECT_EQ(refused["data"]["name"], "wrong_state") << refused;
  EXPECT_EQ(refused["data"].value("hint", ""),
            "set the old value, or make the opposite change; the newest change is "
            "~ first.core.gain: 1 -> 3");
}

TEST(Probation, ConfirmOfAChangeThatIsKeptSaysSo) {
  TrialDaemon daemon;
  const Json change = {{"values", {{"first.core.gain", 3.0}}}, {"probation", "off"}};
  ASSERT_EQ(daemon.ask("param.set", change)["state"], "applied");

  const auto said = daemon.ctl({"confirm"});

  EXPECT_EQ(said.exit, 0);
  EXPECT_EQ(said.out, "generation 2 is kept already: no change is on probation\n");
  EXPECT_EQ(daemon.ask("change.confirm")["changed"], false);
  EXPECT_EQ(daemon.value("first.core.gain"), 3.0);
}

TEST(Probation, ConfirmOfAChangeThatWasRolledBackIsRefused) {
  TrialDaemon daemon;
  ASSERT_EQ(daemon.ask("core.swap", swap_to("trial/throwing_job"))["state"], "applied");
  ASSERT_TRUE(eventually([&] { return daemon.ask("status.get")["generation"] == 3; }));

  const auto refused = daemon.ask("change.confirm");

  EXPECT_EQ(refused["data"]["id"], "nothing_on_probation") << refused;
  EXPECT_THAT(refused["message"].get<std::string>(), HasSubstr("was rolled back"));
}

TEST(Probation, UndoShowsWhatItRollsBackBeforeAndAfter) {
  TrialDaemon daemon;
  ASSERT_EQ(daemon.ask("core.swap", swap_to("trial/other"))["state"], "applied");
  ASSERT_EQ(daemon.ask("param.set", {{"values", {{"first.core.gain", 3.0}}}})["state"], "applied");

  const auto planned = daemon.ask("change.undo", {{"dry_run", true}});
  EXPECT_EQ(planned["generation"], 3) << planned;
  EXPECT_EQ(planned["undone"]["generations"], Json({2, 3}));
  EXPECT_EQ(planned["undone"]["components"], Json({"first"}));
  EXPECT_EQ(daemon.component("first")["core"], "trial/other");

  const auto undone = daemon.ctl({"undo"}).out;
  EXPECT_THAT(undone, HasSubstr("~ first.core: trial/other -> trial/steady\n"));
  EXPECT_THAT(undone, HasSubstr("~ first.core.gain: 3 -> 1\n"));
  EXPECT_THAT(undone, HasSubstr("took back generations 2 to 3 (first) (generation 4)"));
  EXPECT_THAT(daemon.ctl({"why", "first"}).out, HasSubstr("generation 4 by change.undo"));
  EXPECT_EQ(daemon.ask("change.undo", {{"dry_run", true}})["data"]["name"], "wrong_state");
}

TEST(Probation, UndoLeavesTheRollbackOfAnotherComponentInForceAndDoesNotNameIt) {
  TrialDaemon daemon;
  const auto set = [&](double gain) {
    return daemon.ask("param.set", {{"values", {{"second.core.gain", gain}}}})["generation"];
  };
  ASSERT_EQ(set(2.0), 2);
  ASSERT_EQ(daemon.ask("core.swap", swap_to("trial/throwing_job"))["generation"], 3);
  ASSERT_TRUE(eventually([&] { return daemon.ask("status.get")["generation"] == 4; }));
  ASSERT_EQ(set(3.0), 5);

  EXPECT_THAT(daemon.ctl({"undo"}).out, HasSubstr("took back generations 2 and 5 (second)"));
  EXPECT_TRUE(runs(daemon, "trial/steady")) << "the rollback stays";
}

TEST(Probation, ConfirmListsAllThatItConfirms) {
  TrialDaemon daemon;
  ASSERT_EQ(daemon.ask("core.swap", swap_to("trial/other"))["state"], "applied");
  ASSERT_EQ(daemon.ask("param.set", {{"values", {{"second.core.gain", 3.0}}}})["state"], "applied");

  EXPECT_EQ(daemon.ctl({"confirm"}).out,
            "confirmed generation 2 (first), generation 3 (second) (generation 3)\n");
}

TEST(Probation, ValuesThatAreInForceMakeNoGeneration) {
  TrialDaemon daemon;
  ASSERT_EQ(daemon.ask("param.set", {{"values", {{"first.core.gain", 3}}}})["generation"], 2);

  const auto again = daemon.ask("param.set", {{"values", {{"first.core.gain", 3}}}});

  EXPECT_EQ(again["changed"], false) << again;
  EXPECT_EQ(again["generation"], 2);
  EXPECT_EQ(daemon.ask("status.get")["generation"], 2);
  EXPECT_THAT(daemon.ctl({"set", "first.core.gain=3"}).out, HasSubstr("nothing to change"));
}

TEST(Probation, WhatNobodyConfirmsIsRolledBack) {
  TrialDaemon daemon;
  ASSERT_EQ(daemon.ask("core.swap", swap_to("trial/other", {{"confirm_within", "100ms"}}))["state"],
            "applied");

  EXPECT_TRUE(eventually([&] { return daemon.ask("status.get")["generation"] == 3; }));
  EXPECT_TRUE(runs(daemon, "trial/steady"));
}

TEST(Probation, UntilItIsConfirmedItsComponentsStayAsTheyAre) {
  TrialDaemon daemon;
  ASSERT_EQ(daemon.ask("core.swap", swap_to("trial/other", {{"confirm_within", "600s"}}))["state"],
            "applied");
  const auto refused = daemon.ask("core.swap", swap_to("trial/steady"));
  EXPECT_EQ(daemon.ask("param.set", {{"values", {{"second.core.gain", 3.0}}}})["state"], "applied");

  EXPECT_EQ(daemon.ask("change.confirm")["changed"], true);

  EXPECT_EQ(refused["data"]["name"], "conflict") << refused;
  EXPECT_EQ(daemon.ask("param.set", {{"values", {{"second.core.gain", 2.0}}}})["state"], "applied");
  EXPECT_EQ(daemon.component("first")["core"], "trial/other");
  EXPECT_EQ(daemon.ask("change.confirm")["changed"], true) << "of the newer one";
}

TEST(Probation, GoesOnWhenAnotherComponentChanges) {
  TrialDaemon daemon;
  ASSERT_EQ(daemon.ask("core.swap", swap_to("trial/other"))["state"], "applied");
  const auto elsewhere = daemon.ask("param.set", {{"values", {{"second.core.gain", 2.0}}}});
  EXPECT_FALSE(elsewhere.contains("notes")) << elsewhere;

  const auto pending = daemon.ask("status.get")["probations"];
  ASSERT_EQ(pending.size(), 2U) << pending;
  EXPECT_EQ(pending[0]["components"], Json({"first"}));
  EXPECT_EQ(pending[0]["state"], "watching");
  EXPECT_EQ(pending[1]["generations"], Json({3}));
  EXPECT_EQ(daemon.ask("change.undo")["state"], "applied") << "of the newest";
  EXPECT_EQ(daemon.component("first")["core"], "trial/other");
  EXPECT_EQ(daemon.ask("change.undo")["state"], "applied");
  EXPECT_EQ(daemon.component("first")["core"], "trial/steady");
}

TEST(Probation, IsJoinedByANewerChangeOfTheSameComponentAndBothGoBack) {
  TrialDaemon daemon;
  ASSERT_EQ(daemon.ask("core.swap", swap_to("trial/other"))["state"], "applied");

  const auto joined = daemon.ask("core.swap", swap_to("trial/throwing_job"));

  ASSERT_TRUE(joined.contains("notes")) << joined;
  EXPECT_THAT(joined["notes"][0].get<std::string>(), HasSubstr("back to before generation 2"));
  EXPECT_TRUE(eventually([&] { return daemon.component("first")["core"] == "trial/steady"; }));
  EXPECT_EQ(daemon.component("first")["state"], "running");
}

TEST(Probation, OffMeansThatAFaultStaysAFault) {
  TrialDaemon daemon;
  ASSERT_EQ(daemon.ask("core.swap", swap_to("trial/throwing_job", {{"probation", "off"}}))["state"],
            "applied");

  EXPECT_TRUE(eventually([&] { return daemon.component("first")["state"] == "faulted"; }));
  EXPECT_EQ(daemon.ask("status.get")["generation"], 2);
  EXPECT_EQ(
      daemon.ask("core.swap", swap_to("trial/other", {{"probation", "many"}}))["data"]["name"],
      "invalid_value");
}

TEST(Probation, OffLeavesNothingToTolerateOrToConfirm) {
  TrialDaemon daemon;
  for (const auto& [option, value] : {std::pair("misses", "2/64"), {"confirm_within", "30s"}}) {
    const auto refused =
        daemon.ask("core.swap", swap_to("trial/other", {{"probation", "off"}, {option, value}}));
    EXPECT_EQ(refused["data"]["where"], option) << refused;
    EXPECT_EQ(refused["data"]["state"], "unchanged");
    EXPECT_EQ(refused["data"]["hint"], "leave out " + std::string(option) + ", or probation off");
  }
}

/// The record of the first event of this name, when it is there.
Json record_of(TrialDaemon& daemon, const std::string& event) {
  Json found;
  static_cast<void>(eventually([&] {
    const auto log = daemon.ask("log.tail", {{"n", 1000}});
    for (const auto& record : log["records"]) {
      if (record["event"] == event) {
        found = record;
      }
    }
    return !found.is_null();
  }));
  return found;
}

TEST(Probation, AnUndoIsReportedAsUndo) {
  TrialDaemon daemon;
  ASSERT_EQ(daemon.ask("core.swap", swap_to("trial/other"))["state"], "applied");
  ASSERT_EQ(daemon.ask("change.undo")["generation"], 3);

  const auto undone = record_of(daemon, "undone");
  EXPECT_EQ(undone["level"], "info") << undone;
  EXPECT_EQ(undone["text"],
            "the changes of generation 2 were rolled back, 3 is in force: undone by request "
            "~ first.core: trial/other -> trial/steady");
  const auto change = record_of(daemon, "change_applied");
  EXPECT_EQ(change["text"],
            "change.undo by uid " + std::to_string(geteuid()) +
                ": generation 3, applied ~ first.core: trial/other -> trial/steady");
}

TEST(Probation, AnUndoOfSeveralChangesNamesAllTheirGenerations) {
  TrialDaemon daemon;
  ASSERT_EQ(daemon.ask("core.swap", swap_to("trial/other"))["state"], "applied");
  ASSERT_EQ(daemon.ask("core.swap", swap_to("trial/steady"))["state"], "applied");
  ASSERT_EQ(daemon.ask("change.undo")["generation"], 4);

  EXPECT_THAT(record_of(daemon, "undone")["text"].get<std::string>(),
              HasSubstr("the changes of generations 2 to 3 were rolled back, 4 is in force"));
}

TEST(Probation, ARollBackNamesWhoFailed) {
  TrialDaemon daemon;
  ASSERT_EQ(daemon.ask("core.swap", swap_to("trial/throwing_job"))["state"], "applied");

  const auto rolled_back = record_of(daemon, "rolled_back");
  EXPECT_EQ(rolled_back["level"], "error") << rolled_back;
  EXPECT_EQ(rolled_back["text"],
            "the changes of generation 2 were rolled back, 3 is in force: first threw: division by "
            "something "
            "~ first.core: trial/throwing_job -> trial/steady");
}

TEST(Probation, AStopDuringARollBackIsObeyed) {
  TrialDaemon daemon;
  auto client = daemon.client();
  for (int i = 0; i < 10; ++i) {
    // It may go into quarantine a moment after it was rolled back.
    ASSERT_TRUE(eventually([&] {
      static_cast<void>(client.ask("quarantine.release", {{"core", "trial/throwing_job"}}));
      return client.ask("core.swap", swap_to("trial/throwing_job")).contains("result");
    }));
    EXPECT_TRUE(client.ask("component.stop", {{"components", {"first"}}}).contains("result"));
    ASSERT_TRUE(eventually([&] {
      const auto status = daemon.component("first");
      return status["core"] == "trial/steady" || status["state"] == "stopped";
    }));
    static_cast<void>(client.ask("change.undo"));
    ASSERT_TRUE(eventually([&] { return daemon.component("first")["core"] == "trial/steady"; }));
    EXPECT_EQ(daemon.component("first")["state"], "stopped");
    ASSERT_TRUE(client.ask("component.start", {{"components", {"first"}}}).contains("result"));
  }
}

}  // namespace
}  // namespace mauve::test
