// SPDX-License-Identifier: LGPL-3.0-or-later
#include <string>

#include <gtest/gtest.h>

#include "render/render.h"

namespace mauve::ctl {
namespace {

Json analysis() {
  return Json::parse(R"({"components": [
    {"name": "robot", "cpu": 0, "priority": 70, "execution_ns": 500000, "source": "declared",
     "blocking_ns": 0, "deadline_ns": 10000000, "response_ns": 773800, "slack_ns": 9226200},
    {"name": "laser", "cpu": 0, "priority": 60, "execution_ns": 0, "source": "unknown",
     "blocking_ns": 0, "deadline_ns": 25000000, "response_ns": null, "slack_ns": null}],
    "locks": [{"resource": "pose", "lock_budget_ns": 50000, "source": "declared"},
              {"resource": "world", "lock_budget_ns": null, "source": "unknown"}],
    "cpus": [{"cpu": 0, "load": 0.134, "overloaded": false}], "factor": 3.456,
    "problems": [], "notes": ["the machine takes 60us"]})");
}

TEST(RenderAnalysis, IsATableWithAVerdict) {
  EXPECT_EQ(render_analysis(analysis(), {}),
            "NAME   CPU  PRIO  EXECUTION  SOURCE    BLOCKED  RESPONSE  DEADLINE   SLACK\n"
            "robot    0    70     500 us  declared     0 ns    774 us   10.0 ms  9.2 ms\n"
            "laser    0    60          -  unknown      0 ns         -   25.0 ms       -\n"
            "execution time: processor time of a job; response time: elapsed, from its release to "
            "its end\n"
            "LOCK      HOLD  SOURCE\n"
            "pose   50.0 us  declared\n"
            "world        -  unknown\n"
            "proved: deadlines are met up to 3.46 times the execution times; CPU 0: 13 %\n"
            "note: the machine takes 60us\n");
}

TEST(RenderAnalysis, DoesNotSayProvedWhenSomethingIsLateOrUnknown) {
  Json late = analysis();
  late["factor"] = 0.8;
  late["problems"] = {"laser: its job from pace to pace may never end"};
  Json unknown = analysis();
  unknown["factor"] = nullptr;
  Json shared = analysis();
  shared["problems"] = {"world: its lock is shared across CPUs"};

  EXPECT_NE(render_analysis(late, {}).find("not proved: deadlines would be met with 0.80 of"),
            std::string::npos);
  EXPECT_NE(
      render_analysis(late, {}).find("warning: laser: its job from pace to pace may never end\n"),
      std::string::npos);
  EXPECT_NE(render_analysis(unknown, {}).find("not proved: some execution times are unknown"),
            std::string::npos);
  EXPECT_NE(render_analysis(shared, {}).find("not proved: see the warnings"), std::string::npos);
}

TEST(RenderAnalysis, BeginsWithTheMeasurementsThatContradictTheProof) {
  Json over = analysis();
  over["contradictions"] = {"robot used up to 15ms, its budget is 500us", "pose was held for 1ms"};

  const std::string text = render_analysis(over, {});

  EXPECT_EQ(text.find("not valid for what runs: robot used up to 15ms, its budget is 500us; pose "
                      "was held for 1ms\nNAME "),
            0U)
      << text;
  EXPECT_EQ(text.find("proved"), std::string::npos) << text;
  EXPECT_NE(text.find("for the assumed times only: deadlines are met up to 3.46 times"),
            std::string::npos);
}

TEST(RenderAnalysis, SaysWhenNothingRuns) {
  EXPECT_EQ(render_analysis(Json{{"components", Json::array()}}, {}), "no component runs\n");
}

}  // namespace
}  // namespace mauve::ctl
