// SPDX-License-Identifier: LGPL-3.0-or-later
// The command, and the wake-ups.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "doctor/checks.h"
#include "doctor/wake.h"
#include "mauve/host/version.h"
#include "unit/ctl/scene.h"

namespace mauve::ctl::doctor {
namespace {

using testing::HasSubstr;

TEST(Doctor, JudgesThisMachineWithoutADaemon) {
  const auto outcome = run("/nowhere/mauved.sock", {"doctor"});

  EXPECT_THAT(outcome.out, HasSubstr("WARN  mauved: no daemon"));
  EXPECT_THAT(outcome.out, HasSubstr("preemption: "));
  EXPECT_EQ(outcome.exit, outcome.out.find("FAIL  ") == std::string::npos ? 0 : 1);
  EXPECT_EQ(outcome.err, "");
}

TEST(Doctor, AnswersOneLineOfJsonWithEveryCheck) {
  const auto outcome = run("/nowhere/mauved.sock", {"--json", "doctor"});

  const Json result = Json::parse(outcome.out);
  ASSERT_EQ(result["findings"].size(), checks().size());
  for (const Json& one : result["findings"]) {
    EXPECT_THAT(one["grade"].get<std::string>(), testing::AnyOf("ok", "warn", "fail"));
    EXPECT_EQ(one["remedy"].get<std::string>().empty(), one["grade"] == "ok") << one;
  }
  EXPECT_FALSE(result.contains("wake"));
}

TEST(Doctor, EndsWithOneWhereSomethingFails) {
  // To every question the answer of a mauved whose components did not get their threads.
  const Scene scene({"doctor"}, Json::parse(R"({"realtime": "prefer", "generation": 1,
    "version": "0.1.0", "protocol": [1], "abi": 1, "rtprio": 0, "memlock": 0,
    "components": [{"name": "control", "priority": 10, "realtime": false}]})"));

  EXPECT_EQ(scene.outcome.exit, 1);
  EXPECT_THAT(scene.outcome.out, HasSubstr("FAIL  policy in force: without SCHED_FIFO: control"));
  EXPECT_THAT(scene.outcome.out, HasSubstr("      remedy: "));
  ASSERT_EQ(scene.asked.size(), 3U);
  EXPECT_EQ(scene.asked[2].method, "daemon.doctor");
}

TEST(Doctor, MeasuresWakeUpsWhenAsked) {
  const auto outcome = run("/nowhere", {"--json", "doctor", "--wake", "20ms"});

  const Json result = Json::parse(outcome.out);
  ASSERT_TRUE(result.contains("wake"));
  ASSERT_FALSE(result["wake"]["cpus"].empty());
  std::size_t counted = 0;
  for (const Json& cpu : result["wake"]["cpus"]) {
    EXPECT_EQ(cpu["count"], 20);
    EXPECT_LE(cpu["p50_ns"], cpu["max_ns"]);
    counted += 20;
  }
  for (const Json& row : result["wake"]["histogram"]) counted -= row["count"].get<std::size_t>();
  EXPECT_EQ(counted, 0U) << "every wake-up is in one row";
}

TEST(Doctor, RefusesATimeThatIsNone) {
  EXPECT_EQ(run("/nowhere", {"doctor", "--wake", "ten"}).exit, 2);
  EXPECT_EQ(run("/nowhere", {"doctor", "--wake", "2h"}).exit, 2);
}

Wakes wakes_of(std::int64_t usual, std::int64_t longest) {
  Wakes wakes{0, true, std::vector<std::int64_t>(1000, usual)};
  wakes.late_ns[500] = longest;
  return wakes;
}

TEST(WakeUps, AreJudgedByTheirTailAndTheLongest) {
  EXPECT_EQ(judge_wakes({wakes_of(20'000, 300'000)}).grade, Grade::ok);
  EXPECT_EQ(judge_wakes({wakes_of(20'000, 3'000'000)}).grade, Grade::warn);
  EXPECT_EQ(judge_wakes({wakes_of(20'000, 30'000), wakes_of(200'000, 300'000)}).grade, Grade::warn);
  EXPECT_EQ(judge_wakes({wakes_of(2'000'000, 3'000'000)}).grade, Grade::fail);
  EXPECT_EQ(judge_wakes({}).grade, Grade::warn);
}

TEST(WakeUps, OfOrdinaryThreadsProveNothing) {
  Wakes wakes = wakes_of(20'000, 30'000);
  wakes.fifo = false;

  const auto finding = judge_wakes({wakes});

  EXPECT_EQ(finding.grade, Grade::warn);
  EXPECT_THAT(finding.found, HasSubstr("ordinary threads"));
}

TEST(WakeUps, AreDrawnAsAHistogram) {
  const std::string text = render_wakes({wakes_of(20'000, 300'000)}, {60, false});

  EXPECT_THAT(text, HasSubstr("to 20.0 us       999  ##############################\n"));
  EXPECT_THAT(text, HasSubstr("to 500 us         1  #\n"));
  EXPECT_THAT(text, HasSubstr("SCHED_FIFO 94"));
}

TEST(WakeUps, HavePercentiles) {
  Wakes wakes;
  for (int i = 100; i > 0; --i) wakes.late_ns.push_back(i);

  EXPECT_EQ(wakes.percentile(50), 50);
  EXPECT_EQ(wakes.percentile(99), 99);
  EXPECT_EQ(wakes.percentile(100), 100);
  EXPECT_EQ(Wakes{}.percentile(50), 0);
}

}  // namespace
}  // namespace mauve::ctl::doctor
