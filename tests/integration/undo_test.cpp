// SPDX-License-Identifier: LGPL-3.0-or-later
// The undo of changes: its answer, its refusals, and the history.
#include <unistd.h>

#include <atomic>
#include <set>
#include <thread>

#include "kept_daemon.h"

namespace mauve::test {
namespace {

using testing::HasSubstr;

class Undo : public Generations {};

Json on_probation(double value) { return {{"values", {{"first.core.gain", value}}}}; }

TEST_F(Undo, IsInTheHistoryWithTheUserWhoAskedForIt) {
  TrialDaemon daemon(kTrial, options());
  for (const bool in_place : {false, true}) {
    const Json swap = {{"component", "first"}, {"core", "trial/other"}, {"in_place", in_place}};
    ASSERT_EQ(daemon.ask("core.swap", swap)["saved"], true);

    ASSERT_EQ(daemon.ask("change.undo", {{"reason", "too loud"}})["saved"], true);

    const auto undo = newest(daemon);
    EXPECT_EQ(undo["command"], "change.undo") << undo;
    EXPECT_EQ(undo["uid"], getuid());
    EXPECT_EQ(undo["reason"], "too loud");
    EXPECT_THAT(undo["changes"].dump(), HasSubstr("trial/other -> trial/steady"));
  }
}

TEST_F(Undo, IsNoneWhenMauvedRollsBackByItself) {
  TrialDaemon daemon(kTrial, options());
  Json change = on_probation(3.0);
  change["confirm_within"] = "1ms";
  ASSERT_EQ(daemon.ask("param.set", change)["state"], "applied");

  ASSERT_TRUE(eventually([&] { return newest(daemon)["command"] == "rolled_back"; }));

  EXPECT_EQ(newest(daemon)["reason"], "not confirmed within its time");
}

TEST_F(Undo, OfAnUndoneGenerationIsRefusedWithTheUserWhoUndidIt) {
  TrialDaemon daemon(kTrial, options());
  ASSERT_EQ(daemon.ask("param.set", on_probation(3.0))["saved"], true);
  ASSERT_EQ(daemon.ask("change.undo", {{"reason", "too loud"}})["saved"], true);

  const auto refused = daemon.ask("change.undo", {{"generation", 2}});

  EXPECT_EQ(refused["message"],
            "generation 2 was undone already by uid " + std::to_string(getuid()) + ": too loud");
  EXPECT_EQ(refused["data"]["id"], "nothing_to_undo");
  EXPECT_EQ(refused["data"]["state"], "unchanged");
  EXPECT_EQ(refused["data"]["hint"], "mauvectl history shows it");
  end_and_start(daemon);
  EXPECT_EQ(daemon.ask("change.undo", {{"generation", 2}})["message"],
            "generation 2 was rolled back already");
}

TEST_F(Undo, OfARolledBackGenerationIsRefusedWithTheCause) {
  TrialDaemon daemon;
  const Json swap = {{"component", "first"}, {"core", "trial/throwing_job"}};
  ASSERT_EQ(daemon.ask("core.swap", swap)["state"], "applied");
  ASSERT_TRUE(eventually([&] { return daemon.ask("status.get")["generation"] == 3; }));

  const auto refused = daemon.ask("change.undo", {{"generation", 2}});

  EXPECT_EQ(refused["message"],
            "generation 2 was rolled back already: first threw: division by something");
  EXPECT_EQ(refused["data"]["hint"], "mauvectl logs shows it");
}

TEST_F(Undo, OfAValueThatWasSetBackSaysThatNoValueChanges) {
  TrialDaemon daemon;
  for (const double value : {3.0, 1.0}) {
    ASSERT_EQ(daemon.ask("param.set", on_probation(value))["state"], "applied");
  }

  const auto plan = daemon.ask("change.undo", {{"dry_run", true}});
  const auto undone = daemon.ask("change.undo");

  for (const Json& answer : {plan, undone}) {
    EXPECT_EQ(answer["lines"], Json::array());
    EXPECT_EQ(answer["notes"], Json({"the undo changes no value and no connection: it brings back "
                                     "the elements from before generation 2"}));
  }
}

/// Before, an undo counted the lines of the refused change among those that it takes back.
TEST_F(Undo, IsJudgedByNoChangeThatWasRefused) {
  TrialDaemon daemon;
  auto to_confirm = on_probation(3.0);
  to_confirm["confirm_within"] = "600s";
  ASSERT_EQ(daemon.ask("param.set", to_confirm)["state"], "applied");
  ASSERT_EQ(daemon.ask("param.set", on_probation(1.0))["data"]["id"], "waits_for_confirmation");

  const auto plan = daemon.ask("change.undo", {{"dry_run", true}});
  ASSERT_EQ(plan["lines"].size(), 1U) << plan;
  EXPECT_EQ(plan["lines"][0]["new"], 1.0);
  ASSERT_EQ(daemon.ask("lock.set", {{"lock", "params"}})["lock"], "params");

  EXPECT_EQ(daemon.ask("change.undo")["data"]["name"], "conflict");
  EXPECT_EQ(daemon.value("first.core.gain"), 3.0);
}

/// The change said that the probation of the swap in place ends.
TEST_F(Undo, OfTheChangeThatEndedTheProbationOfASwapInPlaceDoesNotReopenIt) {
  TrialDaemon daemon;
  const Json in_place = {{"component", "first"}, {"core", "trial/other"}, {"in_place", true}};
  for (int i = 0; i < 10; ++i) {
    ASSERT_EQ(daemon.ask("core.swap", in_place)["state"], "applied");
    const auto back = daemon.ask("core.swap", {{"component", "first"}, {"core", "trial/steady"}});
    ASSERT_THAT(back["notes"].dump(), HasSubstr("nothing rolls back to the core before it"));

    ASSERT_EQ(daemon.ask("change.undo")["state"], "applied");

    ASSERT_EQ(daemon.ask("change.undo")["data"]["id"], "nothing_to_undo") << i;
  }
}

/// A stop makes a generation while the undo waits for the end of the job of `first`.
TEST_F(Undo, AnswersWhenItsComponentsAreBackAlsoIfAnotherOneIsStoppedMeanwhile) {
  auto file = Json::parse(unguarded());
  auto& first = file["components"]["first"];
  first["core"] = "trial/hungry";
  first["properties"] = {{"fsm.period", "400ms"}, {"core.uses", "200ms"}};
  TrialDaemon daemon(file.dump());
  ASSERT_EQ(daemon.ask("param.set", on_probation(3.0))["state"], "applied");
  auto undoing = daemon.client();
  const auto jobs = daemon.value("first.core.count");
  ASSERT_TRUE(eventually([&] { return daemon.value("first.core.count") != jobs; }));

  ASSERT_TRUE(undoing.send("{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"change.undo\"}\n"));
  ASSERT_TRUE(eventually([&] {
    const auto open = daemon.ask("status.get")["probations"];
    return open.empty() || open[0]["state"] == "rolls_back";
  }));
  EXPECT_TRUE(is_stop(daemon.ask("component.stop", {{"components", {"second"}}})));

  const auto undone = undoing.json();
  EXPECT_EQ(daemon.value("first.core.gain"), 1.0) << undone;
}

/// Two operators, one who changes a value and one who undoes, at the same time.
TEST_F(Undo, BesideChangesRollsBackOnlyWhatItNames) {
  TrialDaemon daemon(unguarded(), {"--realtime", "off"});
  std::atomic<bool> changes{true};
  std::set<std::uint64_t> made;
  std::thread changing([&] {
    auto client = daemon.client();
    for (int i = 0; i < 60; ++i) {
      const Json set = on_probation(1.0 + i);
      EXPECT_TRUE(
          client.send(protocol::to_line(protocol::make_request(i, "param.set", set)) + '\n'));
      const auto answer = client.json();
      if (answer.contains("result"))
        made.insert(answer["result"]["generation"].get<std::uint64_t>());
    }
    changes = false;
  });
  std::set<std::uint64_t> undone;
  while (changes) {
    const auto answer = daemon.ask("change.undo");
    if (answer.contains("undone")) {
      const auto named = answer["undone"]["generations"].get<std::vector<std::uint64_t>>();
      EXPECT_FALSE(named.empty()) << answer;
      undone.insert(named.begin(), named.end());
    } else {
      EXPECT_THAT(answer["data"].value("id", ""),
                  testing::AnyOf("nothing_to_undo", "changed_meanwhile"));
    }
  }
  changing.join();

  EXPECT_FALSE(made.empty());
  const bool was_undone = undone.contains(*made.rbegin());
  EXPECT_EQ(daemon.value("first.core.gain") == 60.0, !was_undone) << "the last value is 60";
}

}  // namespace
}  // namespace mauve::test
