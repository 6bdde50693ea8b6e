// SPDX-License-Identifier: LGPL-3.0-or-later
#include <string>

#include <gtest/gtest.h>

#include "unit/ctl/scene.h"

namespace mauve::ctl {
namespace {

Json times(std::uint64_t count, std::int64_t scale) {
  if (count == 0) {
    return Json::parse(R"({"count": 0, "sum_ns": 0, "min_ns": null, "mean_ns": null,
      "p50_ns": null, "p90_ns": null, "p99_ns": null, "p99_9_ns": null, "max_ns": null})");
  }
  return {{"count", count},      {"sum_ns", static_cast<std::int64_t>(count) * 2 * scale},
          {"min_ns", scale},     {"mean_ns", 2 * scale},
          {"p50_ns", 2 * scale}, {"p90_ns", 3 * scale},
          {"p99_ns", 4 * scale}, {"p99_9_ns", 5 * scale},
          {"max_ns", 6 * scale}};
}

Json component(const char* name) {
  return {{"name", name},
          {"core", "guidance/gap"},
          {"since_ns", 1'000'000'000},
          {"budget_ns", 0},
          {"missed", 0},
          {"overruns", 0},
          {"over_budget", 0},
          {"over_budget_max_ns", 0},
          {"lateness", times(100, 1000)},
          {"execution", times(90, 10'000)},
          {"preempted", times(10, 100'000)},
          {"response", times(100, 20'000)},
          {"lock_waits", {{"count", 0}, {"sum_ns", 0}, {"max_ns", nullptr}}}};
}

Json answer() {
  Json late = component("laser");
  late["budget_ns"] = 50'000;
  late["over_budget"] = 2;
  late["over_budget_max_ns"] = 600'000;
  late["missed"] = 3;
  Json never = component("idle");
  for (const char* key : {"lateness", "execution", "preempted", "response"}) {
    never[key] = times(0, 0);
  }
  return {{"t_ns", 61'000'000'000}, {"components", {component("control"), late, never}}};
}

TEST(RenderStatistics, IsOneRowAComponentWithCleanAndPreemptedApart) {
  EXPECT_EQ(render_statistics(answer(), {}),
            "NAME     JOBS  LATE P99  LATE MAX  EXEC P50  EXEC P99  EXEC MAX  PREEMPTED  RESPONSE  "
            "BUDGET  MISSED  OVERRUNS\n"
            "control   100    4.0 us    6.0 us   20.0 us   40.0 us   60.0 us       10 %    120 us  "
            "     -       0         0\n"
            "laser     100    4.0 us    6.0 us   20.0 us   40.0 us   60.0 us       10 %    120 us  "
            "1200 %       3         0\n"
            "idle        0         -         -         -         -         -          -         -  "
            "     -       0         0\n");
}

TEST(RenderStatistics, LeavesColumnsOutWhereTheTerminalIsNarrow) {
  for (const std::size_t width : {120U, 100U, 80U, 60U, 40U}) {
    const std::string text = render_statistics(answer(), {width, false});
    for (std::size_t at = 0; at < text.size();) {
      const std::size_t end = text.find('\n', at);
      EXPECT_LE(end - at, width) << text;
      at = end + 1;
    }
    EXPECT_NE(text.find("EXEC MAX"), std::string::npos) << width;
  }
  EXPECT_EQ(render_statistics(answer(), {80, false}).find("PREEMPTED"), std::string::npos);
}

TEST(RenderStatistics, ShowsAllFiguresOfOneWithItsStates) {
  Json one = component("control");
  one["budget_ns"] = 120'000;
  one["lock_waits"] = {{"count", 2}, {"sum_ns", 9000}, {"max_ns", 5000}};
  one["states"] = {{{"name", "reach_goal"},
                    {"execution", times(90, 10'000)},
                    {"preempted", {{"count", 4}, {"sum_ns", 400'000}, {"max_ns", 200'000}}}},
                   {{"name", "rest"},
                    {"execution", times(0, 0)},
                    {"preempted", {{"count", 0}, {"sum_ns", 0}, {"max_ns", nullptr}}}}};
  const Json result = {{"t_ns", 61'000'000'000}, {"components", {one}}};

  EXPECT_EQ(render_statistics(result, {}),
            "control: guidance/gap; counted for 1 min\n"
            "JOBS               COUNT     MEAN      P50      P90      P99    P99.9      MAX\n"
            "late by              100   2.0 us   2.0 us   3.0 us   4.0 us   5.0 us   6.0 us\n"
            "execution             90  20.0 us  20.0 us  30.0 us  40.0 us  50.0 us  60.0 us\n"
            "  with preemption     10   200 us   200 us   300 us   400 us   500 us   600 us\n"
            "response             100  40.0 us  40.0 us  60.0 us  80.0 us   100 us   120 us\n"
            "0 releases missed, 0 overruns; budget 120 us: the longest undisturbed job used 50 %; "
            "waited 2 times for resources, 9.0 us in all, at most 5.0 us\n"
            "STATE              COUNT     MEAN      P50      P90      P99    P99.9      MAX\n"
            "reach_goal            90  20.0 us  20.0 us  30.0 us  40.0 us  50.0 us  60.0 us\n"
            "  with preemption      4   100 us        -        -        -        -   200 us\n"
            "rest                   0        -        -        -        -        -        -\n");
}

TEST(RenderStatistics, SaysHowManyJobsExceededTheBudgetAndTheLongestOfThem) {
  Json one = component("smooth");
  one["budget_ns"] = 100'000;
  one["over_budget"] = 10;
  one["over_budget_max_ns"] = 250'000;
  one["states"] = Json::array();

  EXPECT_NE(render_statistics({{"components", {one}}}, {})
                .find("; budget 100 us: exceeded by 10 of 100 jobs, longest 250 us of processor "
                      "time\n"),
            std::string::npos);
}

TEST(RenderStatistics, SurvivesAnswersOfAnotherShape) {
  EXPECT_EQ(render_statistics(Json(), {}), "no component runs\n");
  EXPECT_EQ(render_statistics(Json::parse(R"({"components": 3})"), {}), "no component runs\n");
  const Json odd = Json::parse(R"({"components": [{"name": 5, "states": 7, "execution": []}]})");
  EXPECT_NE(render_statistics(odd, {}).find("no job yet"), std::string::npos);
}

TEST(Stats, AsksForAllOrForOneAddress) {
  const Scene all({"stats"}, answer());
  const Scene one({"stats", "control.reach_goal"}, answer());

  EXPECT_EQ(all.asked.at(0).method, "stats.get");
  EXPECT_EQ(all.asked.at(0).params, Json::object());
  EXPECT_EQ(one.asked.at(0).params, (Json{{"address", "control.reach_goal"}}));
  EXPECT_EQ(Json::parse(Scene({"--json", "stats"}, answer()).outcome.out), answer());
}

TEST(Stats, AreResetOfAllOrOfOne) {
  const Json done = {{"components", {{{"name", "a"}}, {{"name", "b"}}}}, {"changed", true}};
  const Scene all({"stats", "reset"}, done);
  const Scene one({"stats", "reset", "control", "--reason", "tuned"}, done);

  EXPECT_EQ(all.asked.at(0).method, "stats.reset");
  EXPECT_EQ(all.asked.at(0).params, Json::object());
  EXPECT_EQ(all.outcome.out, "counting anew what the jobs of 2 components take\n");
  EXPECT_EQ(one.asked.at(0).params, (Json{{"component", "control"}, {"reason", "tuned"}}));
}

TEST(Stats, TakeOneAddress) {
  const Outcome outcome = run("/nowhere", {"stats", "control", "laser"});

  EXPECT_EQ(outcome.exit, 2);
  EXPECT_NE(outcome.err.find("one address at a time"), std::string::npos);
}

TEST(Metrics, ArePrintedAsTheyCome) {
  const Scene scene({"metrics"}, {{"format", "prometheus 0.0.4"}, {"text", "# HELP a b\na 1\n"}});

  EXPECT_EQ(scene.asked.at(0).method, "metrics.get");
  EXPECT_EQ(scene.outcome.out, "# HELP a b\na 1\n");
  EXPECT_EQ(Scene({"metrics"}, {{"text", 3}}).outcome.out, "");
}

}  // namespace
}  // namespace mauve::ctl
