// SPDX-License-Identifier: LGPL-3.0-or-later
// The value of a generation after a crash, and the cores in quarantine.
#include <atomic>
#include <map>
#include <thread>

#include "kept_daemon.h"
#include "rt/thread/run_guarded.h"

namespace mauve::test {
namespace {

using testing::HasSubstr;

TEST_F(Generations, OnProbationAreNotStartedAfterACrash) {
  TrialDaemon daemon(kTrial, options());
  const auto before = exported(daemon);
  const Json change = {{"values", Json{{"first.core.gain", 3.0}}}, {"confirm_within", "600s"}};
  ASSERT_EQ(daemon.ask("param.set", change)["saved"], true);
  EXPECT_EQ(newest(daemon)["mark"], "unconfirmed");

  crash(daemon);
  daemon.start();

  EXPECT_EQ(exported(daemon), before);
}

TEST_F(Generations, ThatWereConfirmedAreStartedAfterACrash) {
  TrialDaemon daemon(kTrial, options());
  const Json change = {{"values", Json{{"first.core.gain", 3.0}}}, {"confirm_within", "600s"}};
  ASSERT_EQ(daemon.ask("param.set", change)["saved"], true);
  const auto confirmed = daemon.ask("change.confirm");
  crash(daemon);  // at once: the confirmation is on the disk when its answer comes

  EXPECT_EQ(confirmed["changed"], true);
  EXPECT_EQ(confirmed["saved"], true) << confirmed;
  daemon.start();

  EXPECT_EQ(exported(daemon)["components"]["first"]["properties"]["core.gain"], 3.0);
}

TEST_F(Generations, OfAllChangesThatJoinedAreConfirmedTogether) {
  TrialDaemon daemon(kTrial, options());
  ASSERT_EQ(daemon.ask("change.confirm")["saved"], true) << "it has just been started";
  for (const double value : {2.0, 3.0, 4.0}) {
    const Json change = {{"values", Json{{"first.core.gain", value}}}};
    ASSERT_EQ(daemon.ask("param.set", change)["saved"], true);
  }

  ASSERT_EQ(daemon.ask("change.confirm")["confirmed"][0]["generations"], Json({2, 3, 4}));

  EXPECT_TRUE(eventually([&] {
    const auto items = daemon.ask("config.history")["items"];
    const auto confirmed = [](const Json& one) { return one["mark"] == "confirmed"; };
    return !items.empty() && std::ranges::all_of(items, confirmed);
  })) << daemon.ask("config.history");
}

TEST_F(Generations, HaveTheSameNumbersInRefusalsAfterARestart) {
  TrialDaemon daemon(kTrial, options());
  ASSERT_EQ(daemon.ask("param.set", {{"values", Json{{"first.core.gain", 3.0}}}})["saved"], true);
  crash(daemon);
  daemon.start();
  const Json change = {{"values", Json{{"first.core.gain", 4.0}}}, {"confirm_within", "600s"}};
  const auto made = daemon.ask("param.set", change)["generation"];

  const auto refused = daemon.ask("param.set", {{"values", Json{{"first.core.gain", 5.0}}}});

  EXPECT_EQ(refused["data"]["where"], "generation " + made.dump()) << refused;
  EXPECT_EQ(newest(daemon)["generation"], made);
}

TEST_F(Generations, ThatWereRolledBackAreMarkedAndTheOldOneIsSavedAgain) {
  TrialDaemon daemon(kTrial, options());
  const auto before = exported(daemon);
  ASSERT_EQ(daemon.ask("change.confirm")["saved"], true) << "it has just been started";
  ASSERT_EQ(daemon.ask("param.set", {{"values", Json{{"first.core.gain", 3.0}}}})["saved"], true);
  ASSERT_EQ(daemon.ask("change.undo")["state"], "applied");

  ASSERT_TRUE(eventually([&] {
    const auto items = daemon.ask("config.history")["items"];
    return items.size() == 3U && items[0]["mark"] == "confirmed" &&
           items[1]["mark"] == "rolled_back";
  }));
  crash(daemon);
  daemon.start();

  EXPECT_EQ(exported(daemon), before);
}

/// The look that saves a rollback comes up to 20 ms after it, and a change may be quicker.
TEST_F(Generations, AreNotConfirmedByTheRollbackOfTheOneBefore) {
  TrialDaemon daemon(kTrial, options());
  ASSERT_EQ(daemon.ask("change.confirm")["saved"], true) << "it has just been started";
  const auto unproven = [](double value) -> Json {
    return {{"values", {{"first.core.gain", value}}}, {"confirm_within", "600s"}};
  };
  const auto rolled_back = [&] {
    const auto lines = audit_lines();
    return std::ranges::count_if(lines,
                                 [](const Json& line) { return line["method"] == "rolled_back"; });
  };
  int looked_at = 0;
  for (int i = 0; i < 6; ++i) {
    if (i > 0) {
      ASSERT_EQ(daemon.ask("change.undo")["state"], "applied");
    }
    ASSERT_TRUE(eventually([&] { return rolled_back() == 2 * i; }));
    ASSERT_EQ(daemon.ask("param.set", unproven(2.0))["saved"], true);
    auto undoing = daemon.client();
    ASSERT_TRUE(undoing.send("{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"change.undo\"}\n"));
    auto changing = daemon.client();
    ASSERT_TRUE(eventually([&] {  // refused until the other one is undone
      return changing.ask("param.set", unproven(3.0)).contains("result");
    }));
    ASSERT_TRUE(eventually([&] { return rolled_back() == 2 * i + 1; }));
    const auto history = daemon.ask("config.history");
    for (const auto& one : history["items"]) {
      const auto text = TempDir::read(file(std::to_string(one["generation"].get<int>())));
      const auto saved = Json::parse(text, nullptr, false, true);
      const Json::json_pointer at("/components/first/properties/core.gain");
      if (!saved.is_object() || saved.value(at, 0.0) != 3.0) continue;
      ++looked_at;
      EXPECT_EQ(one["mark"] == "confirmed", false) << one;
    }
  }
  EXPECT_GT(looked_at, 0);
  crash(daemon);
  daemon.start();

  EXPECT_EQ(daemon.value("first.core.gain"), 1.0) << daemon.errors();
}

/// A start is on probation too.
TEST_F(Generations, ThatCrashSoonAfterTheirStartAreNotStartedAgain) {
  TrialDaemon daemon(kTrial, options());
  ASSERT_EQ(daemon.ask("param.set", gain(3.0))["saved"], true);
  end_and_start(daemon);
  ASSERT_EQ(daemon.value("first.core.gain"), 1.0) << "after an orderly end the file is started";
  EXPECT_EQ(newest(daemon)["mark"], "unconfirmed");

  crash(daemon);
  daemon.start();

  EXPECT_EQ(daemon.value("first.core.gain"), 3.0) << "the last one that had proved itself";
  EXPECT_EQ(newest(daemon)["command"], "recover");
}

TEST_F(Generations, OfAStartAreConfirmedWhenNothingFailed) {
  TrialDaemon daemon(kTrial, options());
  EXPECT_EQ(newest(daemon)["mark"], "unconfirmed");
  ASSERT_EQ(daemon.ask("param.set", {{"values", Json{{"first.core.gain", 3.0}}}})["saved"], true);
  ASSERT_EQ(daemon.ask("change.undo")["state"], "applied");

  EXPECT_TRUE(eventually([&] {
    const auto items = daemon.ask("config.history")["items"];
    return items.size() == 3U && items[0]["mark"] == "confirmed" && items[2]["mark"] == "confirmed";
  })) << "it runs again what was started";
}

TEST_F(Generations, OfAStartAreNotConfirmedByAChangeThatChangesNothing) {
  TrialDaemon daemon(kTrial, options());

  const auto same = daemon.ask("param.set", gain(1.0));

  EXPECT_EQ(same["changed"], false) << same;
  EXPECT_EQ(same["saved"], true) << same;
  EXPECT_EQ(newest(daemon)["mark"], "unconfirmed");
  EXPECT_EQ(newest(daemon)["command"], "start");
}

/// Generation 2 is good; what a file brings crashes again and again, each time after it was
/// confirmed.
TEST_F(Generations, ThatCrashThriceInARowArePassedOverAndPushNobodyOut) {
  if (!rt::kGuardsFaults) GTEST_SKIP() << "NOT TESTED: sanitizers handle faults themselves";
  TrialDaemon daemon(kTrial, options());
  ASSERT_EQ(daemon.ask("param.set", gain(2.0))["saved"], true);
  ASSERT_EQ(daemon.ask("param.set", gain(3.0))["saved"], true);
  crash(daemon);  // of a run that had started with another one: it does not count
  daemon.start();
  for (int crashes = 1; crashes <= 3; ++crashes) {
    ASSERT_EQ(daemon.value("first.core.gain"), 3.0) << crashes;
    ASSERT_EQ(daemon.ask("change.confirm")["saved"], true) << crashes;
    fail(daemon);
    daemon.start();
  }

  EXPECT_EQ(daemon.value("first.core.gain"), 2.0);
  EXPECT_TRUE(was_logged(daemon, "generation_passed_over"));
  EXPECT_EQ(daemon.ask("config.history")["items"].size(), 4U)
      << "2, 3, one copy of it, and the one that runs";
}

TEST_F(Generations, ThatCameToAnOrderlyEndMeanwhileDidNotCrashInARow) {
  if (!rt::kGuardsFaults) GTEST_SKIP() << "NOT TESTED: sanitizers handle faults themselves";
  TrialDaemon daemon(kTrial, options());
  ASSERT_EQ(daemon.ask("param.set", gain(2.0))["saved"], true);
  ASSERT_EQ(daemon.ask("param.set", gain(3.0))["saved"], true);
  for (int crashes = 0; crashes < 5; ++crashes) {
    fail(daemon);
    daemon.start();
    ASSERT_EQ(daemon.value("first.core.gain"), 3.0) << crashes;
    if (crashes == 2) {
      end_and_start(daemon);
      static_cast<void>(daemon.client());
    }
  }
}

TEST_F(Generations, ThatCrashAtOnceInALoopPushNobodyOut) {
  TrialDaemon daemon(kTrial, options());
  ASSERT_EQ(daemon.ask("param.set", gain(2.0))["saved"], true);
  for (int i = 0; i < 6; ++i) {
    crash(daemon);
    daemon.start();
    static_cast<void>(daemon.client());
  }

  EXPECT_EQ(daemon.ask("config.history")["items"].size(), 2U) << "2 and the last start";
}

TEST_F(Generations, ThatGoBackToAnUnconfirmedOneAreUnconfirmed) {
  TrialDaemon daemon(kTrial, options());
  const auto proved = exported(daemon);
  ASSERT_EQ(daemon.ask("param.set", {{"values", Json{{"first.core.gain", 3.0}}}})["saved"], true);
  ASSERT_EQ(daemon.ask("param.set", {{"values", Json{{"second.core.gain", 4.0}}}})["saved"], true);
  const auto undone = daemon.ask("change.undo");
  ASSERT_EQ(undone["generation"], 4) << undone;

  ASSERT_TRUE(eventually([&] {
    const auto items = daemon.ask("config.history")["items"];
    return items.size() == 4U && items[1]["mark"] == "rolled_back";
  }));
  const auto items = daemon.ask("config.history")["items"];
  EXPECT_EQ(items[0]["mark"], "unconfirmed");
  EXPECT_EQ(items[2]["mark"], "unconfirmed") << "it was overtaken";
  EXPECT_EQ(exported(daemon)["components"]["first"]["properties"]["core.gain"], 3.0);

  crash(daemon);
  daemon.start();

  EXPECT_EQ(exported(daemon), proved);
}

/// The content of the next change is not saved under the number of the one before.
TEST_F(Generations, ThatGoBackKeepTheirContentBesideANewerChange) {
  TrialDaemon daemon(kTrial, options());
  auto client = daemon.client();
  ASSERT_EQ(client.ask("param.set", gain(2.0))["result"]["saved"], true);
  std::map<std::string, Json> wanted;
  for (double value = 3.0; value < 9.0; value += 0.25) {
    const auto before = client.ask("config.get")["result"]["architecture"]["components"];
    const Json set_on_probation = {{"values", {{"first.core.gain", 10.0}}},
                                   {"confirm_within", "600s"}};
    ASSERT_EQ(client.ask("param.set", set_on_probation)["result"]["saved"], true);
    const auto undone = client.ask("change.undo")["result"]["generation"];
    const Json next = {{"values", {{"first.core.gain", value}}}, {"confirm_within", "600s"}};
    ASSERT_EQ(client.ask("param.set", next)["result"]["saved"], true);
    ASSERT_EQ(client.ask("change.confirm")["result"]["saved"], true);
    wanted[undone.dump()] = before;
  }
  ASSERT_EQ(client.ask("lock.set", {{"lock", "none"}})["result"]["saved"], true);
  crash(daemon);

  for (const auto& [number, content] : wanted) {
    const auto saved = Json::parse(TempDir::read(file(number)), nullptr, true, true);
    EXPECT_EQ(saved["components"], content) << "generation " << number;
  }
}

TEST_F(Generations, OfAReloadOrASwapInPlaceAreUnconfirmedUntilTheyAreConfirmed) {
  TrialDaemon daemon(kTrial, options());
  static_cast<void>(daemon.client());
  daemon.install(2);
  ASSERT_EQ(daemon.ask("plugin.reload", {{"plugin", "trial"}, {"probation", "off"}})["saved"],
            true);
  EXPECT_EQ(newest(daemon)["mark"], "unconfirmed");
  EXPECT_EQ(daemon.ask("change.confirm")["changed"], true);
  EXPECT_TRUE(eventually([&] { return newest(daemon)["mark"] == "confirmed"; }));
  const auto again = daemon.ask("change.confirm");
  EXPECT_EQ(again["changed"], false) << "it is: " << again;
  EXPECT_EQ(again["saved"], true) << again;
  EXPECT_EQ(newest(daemon)["mark"], "confirmed");

  const auto proved = exported(daemon);
  const Json swap = {
      {"component", "first"}, {"core", "trial/other"}, {"in_place", true}, {"probation", "off"}};
  ASSERT_EQ(daemon.ask("core.swap", swap)["saved"], true);
  EXPECT_EQ(newest(daemon)["mark"], "unconfirmed");

  crash(daemon);
  daemon.start();

  EXPECT_EQ(exported(daemon), proved);
}

TEST_F(Generations, AreUnconfirmedAsLongAsAnyChangeInThemIs) {
  TrialDaemon daemon(kTrial, options());
  Json swap = {{"component", "first"}, {"core", "trial/other"}, {"confirm_within", "600s"}};
  ASSERT_EQ(daemon.ask("core.swap", swap)["saved"], true);
  ASSERT_EQ(daemon.ask("core.swap", {{"component", "second"},
                                     {"core", "trial/other"},
                                     {"in_place", true},
                                     {"probation", "off"}})["saved"],
            true);
  ASSERT_TRUE(eventually([&] { return daemon.ask("status.get")["uptime_s"] > 13; },
                         std::chrono::seconds(60)));
  EXPECT_EQ(newest(daemon)["mark"], "unconfirmed") << "the first change waits for its confirmation";

  ASSERT_EQ(daemon.ask("change.confirm")["saved"], true);

  EXPECT_EQ(newest(daemon)["mark"], "confirmed");
}

TEST_F(Generations, OfAReloadAreConfirmedWhenNothingFailed) {
  TrialDaemon daemon(kTrial, options());
  static_cast<void>(daemon.client());
  daemon.install(2);
  ASSERT_EQ(daemon.ask("plugin.reload", {{"plugin", "trial"}, {"probation", "off"}})["saved"],
            true);

  EXPECT_TRUE(
      eventually([&] { return newest(daemon)["mark"] == "confirmed"; }, std::chrono::seconds(60)));
}

/// Every look takes the running system further, also between a change and its answer.
TEST_F(Generations, OfAChangeAndOfItsRollbackAreBothSavedHoweverSoonItFails) {
  TrialDaemon daemon(kTrial, options());
  auto onlooker = daemon.client();
  std::atomic<bool> end{false};
  std::thread looking([&] {
    while (!end && onlooker.ask("status.get").contains("result")) continue;
  });
  const Json swap = {{"component", "first"}, {"core", "trial/throwing_job"}};
  for (std::uint64_t number = 2; number <= 20; number += 2) {
    EXPECT_TRUE(eventually([&] {
      static_cast<void>(daemon.ask("quarantine.release", {{"core", "trial/throwing_job"}}));
      return daemon.ask("core.swap", swap).contains("saved");
    }));
    EXPECT_TRUE(eventually([&] { return newest(daemon)["generation"] == number + 1; }));
    EXPECT_TRUE(eventually(
        [&] { return daemon.ask("config.history")["items"][1]["mark"] == "rolled_back"; }));
    const auto items = daemon.ask("config.history")["items"];
    EXPECT_EQ(items[0]["command"], "rolled_back") << items;
    EXPECT_EQ(items[1]["command"], "core.swap") << items;
    EXPECT_EQ(items[1]["generation"], number) << items;
    EXPECT_TRUE(eventually([&] { return !daemon.ask("quarantine.list")["cores"].empty(); }));
    if (HasFailure()) break;
  }
  end = true;
  looking.join();
  EXPECT_THAT(daemon.errors(), Not(HasSubstr("not saved")));
}

TEST_F(Generations, AreMadeWithoutTheCoresInQuarantineAlsoAfterARestart) {
  TrialDaemon daemon(kTrial, options());
  const Json swap = {{"component", "first"}, {"core", "trial/throwing_job"}};
  ASSERT_EQ(daemon.ask("core.swap", swap)["state"], "applied");
  ASSERT_TRUE(eventually([&] { return daemon.ask("quarantine.list")["cores"].size() == 1U; }));
  const auto list = daemon.ask("quarantine.list");
  ASSERT_EQ(daemon.ask("param.set", gain(2.0))["saved"], true) << "and so is what came before";

  crash(daemon);
  daemon.start();
  EXPECT_EQ(daemon.ask("quarantine.list"), list);
  EXPECT_THAT(daemon.ask("core.swap", swap)["message"].get<std::string>(),
              HasSubstr("is in quarantine, since it failed: threw"));

  daemon.install(2);
  end_and_start(daemon);
  const auto other_build = daemon.ask("core.swap", swap);
  EXPECT_EQ(other_build["state"], "applied") << "another build may be tried: " << other_build;

  ASSERT_TRUE(eventually([&] { return daemon.ask("quarantine.list")["cores"].size() == 2U; }));
  ASSERT_EQ(daemon.ask("quarantine.release", {{"core", "trial/throwing_job"}})["saved"], true);
  end_and_start(daemon);
  EXPECT_EQ(daemon.ask("quarantine.list")["cores"].size(), 0U);
}

}  // namespace
}  // namespace mauve::test
