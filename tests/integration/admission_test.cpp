// SPDX-License-Identifier: LGPL-3.0-or-later
/// The answers of a daemon about response times, and the changes that it refuses because of them.
#include "rt/thread/thread.h"
#include "trial_daemon.h"

namespace mauve::test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

const std::vector<std::string> kStrict{"--realtime", "off", "--admission", "strict"};

/// Two components with budgets, `first` with this one.
std::string budgeted(const std::string& budget) {
  std::string text = kTrial;
  const auto add = [&](const std::string& ports, const std::string& time) {
    const std::string task = R"(, "task": { "cpus": [0], "budget": ")" + time + "\" }";
    text.insert(text.find(ports) + ports.size(), task);
  };
  add(R"("ports": { "output": "signal.write" })", budget);
  add(R"("ports": { "input": "signal.read" })", "100us");
  return text;
}

Json swap_with_budget(const std::string& budget) {
  return {{"component", "first"}, {"core", "trial/other"}, {"budget", budget}};
}

TEST(Analyze, ShowsTheBoundOfEveryComponentAndTheShareOfTheMachine) {
  TrialDaemon daemon(budgeted("200us"));

  const Json timing = daemon.ask("system.analyze");

  ASSERT_EQ(timing["components"].size(), 2U) << timing;
  const Json& first = timing["components"][0];
  EXPECT_EQ(first["name"], "first");
  EXPECT_EQ(first["source"], "declared");
  EXPECT_EQ(first["execution_ns"], 200'000);
  EXPECT_EQ(first["deadline_ns"], 2'000'000);
  EXPECT_EQ(first["slack_ns"].get<std::int64_t>(),
            first["deadline_ns"].get<std::int64_t>() - first["response_ns"].get<std::int64_t>());
  EXPECT_THAT(timing["problems"], IsEmpty());
  EXPECT_GT(timing["factor"].get<double>(), 1.0);
  EXPECT_THAT(timing["notes"].dump(),
              HasSubstr("assumed of the machine: 120us to wake a thread up"));
  EXPECT_EQ(timing["machine"]["assumed"]["wake_ns"], 120'000);
  EXPECT_THAT(timing["machine"]["measured"], IsEmpty()) << "ordinary threads have no probe";
}

TEST(Analyze, ShowsTheNoiseOfTheMachineBesideWhatIsAssumed) {
  if (!rt::may_use_fifo(99)) GTEST_SKIP() << "NOT TESTED: no SCHED_FIFO here";
  TrialDaemon daemon(budgeted("200us"), {"--machine", "wake=1ns"});

  Json measured;
  EXPECT_TRUE(eventually([&] {
    measured = daemon.ask("system.analyze")["machine"]["measured"];
    return measured.size() == 1U && measured[0]["count"] > 10;
  })) << "both components run on CPU 0";

  EXPECT_LE(measured[0]["beyond"], measured[0]["count"]);
  EXPECT_GE(measured[0]["worst_ns"], measured[0]["p50_ns"]);
  // No thread wakes up within 1 ns; wake-ups that are counted during the look may be missing.
  EXPECT_TRUE(eventually([&] {
    return daemon.ask("system.analyze")["notes"].dump().find("; 100 % of ") != std::string::npos;
  })) << "and says so";
}

TEST(StrictAdmission, NamesTheAssumptionWhereItDecidesAndStartAndCheckAgree) {
  const std::vector<std::string> slow{"--machine", "wake=1.9ms"};
  auto strict = kStrict;
  strict.insert(strict.end(), slow.begin(), slow.end());
  TrialDaemon daemon(budgeted("200us"), strict);
  EXPECT_TRUE(eventually([&] { return !daemon.process().running(); }));
  EXPECT_TRUE(daemon.says("assumed of the machine: 1.9ms to wake a thread up")) << daemon.errors();

  auto words = daemon.command();
  words.emplace_back("--check");
  Process check(words, (daemon.place() / "check.txt").string());
  static_cast<void>(check.all_output());
  EXPECT_EQ(check.wait(), 1);
  EXPECT_THAT(TempDir::read(daemon.place() / "check.txt"), HasSubstr("not admitted: first"));
}

TEST(Check, WritesLongTimesInSeconds) {
  TrialDaemon daemon(budgeted("1500ms"), {"--realtime", "off", "--admission", "off"});
  auto words = daemon.command();
  words.emplace_back("--check");
  Process check(words);

  EXPECT_THAT(check.all_output(), HasSubstr(" 1.5 s declared"));
}

TEST(Swap, DeclaresTheBudgetOfTheNewCore) {
  TrialDaemon daemon;

  const Json receipt = daemon.ask("core.swap", swap_with_budget("2ms"));

  EXPECT_EQ(receipt["state"], "applied") << receipt;
  EXPECT_EQ(daemon.ask("object.get", {{"address", "first"}})["task"]["budget"], "2ms");
  EXPECT_EQ(daemon.ask("core.swap", swap_with_budget("2"))["data"]["where"], "budget");
}

TEST(StrictAdmission, RefusesACoreWhoseBudgetIsOverItsDeadlineAndSaysWhatWouldPass) {
  TrialDaemon daemon(budgeted("200us"), kStrict);

  const Json error = daemon.ask("core.swap", swap_with_budget("3ms"));

  EXPECT_EQ(error["data"]["where"], "first") << error;
  EXPECT_EQ(error["data"]["state"], "unchanged");
  EXPECT_THAT(error["message"].get<std::string>(), HasSubstr("its deadline is 2ms"));
  EXPECT_THAT(error["data"]["hint"].get<std::string>(), HasSubstr("an execution time of 1."));
  EXPECT_EQ(daemon.component("first")["core"], "trial/steady");
  EXPECT_EQ(daemon.ask("core.swap", swap_with_budget("1ms"))["state"], "applied");
}

TEST(StrictAdmission, DoesNotStartWhatIsNotProved) {
  TrialDaemon daemon(kTrial, kStrict);

  EXPECT_TRUE(eventually([&] { return !daemon.process().running(); }));

  EXPECT_TRUE(daemon.says("the execution time of a job is not known")) << daemon.errors();
  EXPECT_TRUE(daemon.says("declare a budget")) << daemon.errors();
}

TEST(WarningAdmission, AppliesTheSameSwapAndSaysSoInTheAnswer) {
  TrialDaemon daemon(budgeted("200us"));

  const Json receipt = daemon.ask("core.swap", swap_with_budget("3ms"));

  EXPECT_EQ(receipt["state"], "applied") << receipt;
  EXPECT_THAT(receipt["warnings"].dump(), HasSubstr("first: its job"));
}

}  // namespace
}  // namespace mauve::test
