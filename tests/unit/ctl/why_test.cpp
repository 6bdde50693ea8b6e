// SPDX-License-Identifier: LGPL-3.0-or-later
// Why a component failed, as users read it.
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "render/render.h"
#include "unit/ctl/scene.h"

namespace mauve::ctl {
namespace {

const Json kLastRecord = Json::parse(R"({"seq": 7, "t": "2026-01-01T09:59:59.000000Z",
  "level": "warn", "component": "control", "event": "core_message", "text": "no scan"})");

const Json kWhy = Json::parse(R"({"component": "control", "state": "faulted", "core": "g/gap",
  "late_ns": 0, "missed": 3, "overruns": 1,
  "kernel": {"minor_faults": 7, "major_faults": 1, "waits": 17, "preemptions": 2},
  "since": "2026-01-01T09:00:00.0Z", "failure": {"time": "2026-01-01T10:00:00.0Z",
    "ago_ns": 3000000000, "cause": "threw", "text": "sensor lost", "core": "g/gap",
    "build_id": "9c32e8201234567890", "fsm_state": "go", "job": 17, "did": "parked",
    "core_after": "g/gap", "generation": 42, "generation_after": 42, "times": 2},
  "change": {"generation": 42, "time": "2026-01-01T09:59:00.0Z", "method": "core.swap", "uid": 7,
    "reason": "try it"}, "poisoned": ["world"], "quarantine": [],
  "hints": ["mauvectl start control --reset: again"]})");

/// Of a component that runs and has not failed.
Json without_failure() {
  Json answer = kWhy;
  answer["state"] = "running";
  answer["failure"] = nullptr;
  answer["missed"] = answer["overruns"] = 0;
  return answer;
}

TEST(Why, NamesTheRuleThatMadeAChangeAndNoUser) {
  Json answer = without_failure();
  answer["change"].update({{"method", "supervision"}, {"uid", 0}, {"reason", "by rule far"}});

  const std::string text = render_why(answer, {});

  EXPECT_THAT(text, testing::HasSubstr("generation 42 by rule far, 2026-01-01T09:59:00.0Z\n"));
}

TEST(Why, IsAnsweredInAFewLines) {
  Json answer = kWhy;
  answer["records"] = Json::array({kLastRecord});
  const Scene scene({"why", "control"}, answer);

  EXPECT_EQ(scene.asked[0].method, "component.why");
  EXPECT_EQ(scene.asked[0].params, (Json{{"component", "control"}}));
  EXPECT_EQ(scene.outcome.out,
            "control: faulted, core g/gap\n"
            "what      threw: sensor lost, in state go, job 17, core g/gap (build 9c32e8201234)\n"
            "when      2026-01-01T10:00:00.0Z, 3.0 s ago; 2 failures since mauved began\n"
            "then      it was stopped with its safe values written; others go on\n"
            "before    generation 42 by core.swap, uid 7, 2026-01-01T09:59:00.0Z: try it\n"
            "counted   3 releases missed, 1 overrun; the kernel counts, since the thread began: 8 "
            "page faults (1 from disk), 17 waits, preempted 2 times\n"
            "poisoned  world\n"
            "next      mauvectl start control --reset: again\n"
            "records up to this failure\n" +
                render_record(kLastRecord, {}));
}

TEST(Why, NamesTheLatenessAndTheLastChangeBeforeAnOlderFailure) {
  Json answer = kWhy;
  answer["state"] = "running";
  answer["core"] = "g/steady";
  answer["late_after"] = true;
  answer["change_after"] = kWhy["change"];
  answer["change_after"]["generation"] = 45;
  answer["change_after"]["method"] = "param.set";
  answer["records"] = Json::array({kLastRecord});
  const std::string text = Scene({"why", "control"}, answer).outcome.out;

  EXPECT_THAT(text, testing::StartsWith(
                        "control: running, core g/steady; failed before, and is late now: 3 "
                        "releases missed, 1 overrun\n"
                        "changed   generation 45 by param.set, uid 7, 2026-01-01T09:59:00.0Z: try "
                        "it\n"
                        "failed    threw: sensor lost"));
  EXPECT_THAT(text, testing::HasSubstr("\nits last records\n"));
}

TEST(Why, NamesTheLastRollbackOfAChangeUnlessTheFailureDoes) {
  Json answer = without_failure();
  answer["rollback"] = {{"generation", 44},
                        {"undone", {42, 43}},
                        {"time", "2026-01-01T10:01:00.500000Z"},
                        {"cause", "not confirmed before calm began"},
                        {"uid", nullptr}};
  const std::string line =
      "back      generations 42 to 43 were rolled back at 2026-01-01 10:01:00Z, in generation 44: "
      "not confirmed before calm began\n";
  EXPECT_THAT(Scene({"why", "control"}, answer).outcome.out, testing::HasSubstr(line));

  answer["failure"] = kWhy["failure"];
  answer["failure"]["generation_after"] = 44;
  EXPECT_THAT(Scene({"why", "control"}, answer).outcome.out,
              testing::Not(testing::HasSubstr("back  ")));
}

TEST(Why, NamesTheResourceInWhoseCallTheJobFailed) {
  Json answer = kWhy;
  answer["failure"]["resource"] = "world";
  const Scene scene({"why", "control"}, answer);

  EXPECT_NE(scene.outcome.out.find("threw: sensor lost, in a call of world, in state go, job 17, "),
            std::string::npos)
      << scene.outcome.out;
}

TEST(Why, DoesNotSayThatAStoppedComponentRunsAgain) {
  Json answer = kWhy;
  answer["failure"]["did"] = "rolled_back";
  answer["records"] = Json::array();
  answer["failure"]["state_after"] = "running";
  EXPECT_THAT(Scene({"why", "control"}, answer).outcome.out,
              testing::HasSubstr("rolled back: g/gap runs again (generation 42)"));
  answer["failure"]["state_after"] = "stopped";
  EXPECT_THAT(Scene({"why", "control"}, answer).outcome.out,
              testing::HasSubstr("rolled back: g/gap is in its place again, and the component is "
                                 "stopped (generation 42)"));
}

TEST(Why, NothingFailedIsTwoLines) {
  Json answer = without_failure();
  answer["change"] = nullptr;
  answer["kernel"] = nullptr;
  answer["poisoned"] = answer["hints"] = Json::array();

  EXPECT_EQ(Scene({"why", "control"}, answer).outcome.out,
            "control: running, core g/gap; nothing failed since mauved began, "
            "2026-01-01T09:00:00.0Z\n"
            "counted   0 releases missed, 0 overruns\n");
}

TEST(Why, AComponentThatIsLateDidNotFailButIsLate) {
  Json answer = without_failure();
  answer["missed"] = 126;
  answer["overruns"] = 259;
  answer["over_budget"] = 253;
  answer["budget_ns"] = 100'000;
  answer["elapsed_max_ns"] = 15'000'000;
  answer["used_max_ns"] = 14'900'000;

  const std::string text = Scene({"why", "control"}, answer).outcome.out;

  EXPECT_THAT(text, testing::StartsWith(
                        "control: running, core g/gap; did not fail, but is late: 126 releases "
                        "missed, 259 overruns, 253 jobs over the budget of 100 us (longest 14.9 "
                        "ms of processor time)\n"));
  EXPECT_THAT(text, testing::Not(testing::HasSubstr("nothing failed")));
}

TEST(Why, AComponentThatIsInTimeAndExceededItsBudgetSaysSo) {
  Json answer = without_failure();
  answer["over_budget"] = 1;
  answer["budget_ns"] = 2'000'000;
  answer["used_max_ns"] = 8'000'000;

  EXPECT_THAT(Scene({"why", "control"}, answer).outcome.out,
              testing::StartsWith("control: running, core g/gap; did not fail, but has 1 job over "
                                  "the budget of 2.0 ms (longest 8.0 ms of processor time)\n"));
}

TEST(Why, AComponentThatAUserStoppedNamesTheUser) {
  Json answer = without_failure();
  answer["stopped_by"] = "uid 1000 stopped it at 2026-01-01T10:00:00.0Z";
  EXPECT_THAT(Scene({"why", "control"}, answer).outcome.out,
              testing::HasSubstr("stopped   uid 1000 stopped it at 2026-01-01T10:00:00.0Z; only "
                                 "mauvectl start control starts it again\n"));
}

TEST(Why, OfAnAnswerThatMakesNoSenseDoesNotFail) {
  for (const char* text : {"null", "{}", "[]", R"({"failure": {}, "records": [1], "hints": 3})"}) {
    EXPECT_FALSE(render_why(Json::parse(text), {80, true}).empty()) << text;
  }
}

TEST(Why, NamesThePortsThatDidNotLetValuesOut) {
  Json answer = without_failure();
  answer["implausible"] = Json::parse(R"([{"port": "grip", "count": 1},
                                          {"port": "speed", "count": 12}])");

  std::string text = render_why(answer, {});
  EXPECT_THAT(text, testing::StartsWith(
                        "control: running, core g/gap; did not fail, but its core wrote values "
                        "that are not plausible\n"));
  EXPECT_THAT(text, testing::HasSubstr(
                        "withheld  by grip (1 value was not plausible), speed (12 values were not "
                        "plausible): readers keep the value before\n"));

  answer["missed"] = 2;
  text = render_why(answer, {});
  EXPECT_THAT(text, testing::StartsWith("control: running, core g/gap; did not fail, but is late"));
  EXPECT_THAT(text, testing::HasSubstr("withheld  by grip"));
}

}  // namespace
}  // namespace mauve::ctl
