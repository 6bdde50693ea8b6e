// SPDX-License-Identifier: LGPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "render/render.h"

namespace mauve::ctl {
namespace {

using testing::HasSubstr;

Json with(const char* key, Json value) {
  Json status = {{"generation", 4}, {"architecture", "a"}, {"components", Json::array()}};
  status[key] = std::move(value);
  return status;
}

Json probation(const char* state, double left) {
  return Json::array({{{"generations", {3, 4}},
                       {"components", {"control", "base"}},
                       {"state", state},
                       {"left_ns", left},
                       {"jobs", 3000},
                       {"jobs_left", 1200}}});
}

TEST(RenderPending, IsEmptyWhenAllIsSettled) {
  EXPECT_EQ(render_pending(with("probations", Json::array()), {}), "");
  EXPECT_EQ(render_pending(with("recovered", nullptr), {}), "");
}

TEST(RenderPending, ShowsHowLongAChangeIsOnProbationAndWhatCausesARollback) {
  EXPECT_EQ(render_pending(with("probations", probation("watching", 6e9)), {}),
            "generations 3 to 4 (control, base): on probation for 6 s still, or 1200 jobs: a "
            "failure, or mauvectl undo, rolls back\n");
  EXPECT_THAT(render_status(with("probations", probation("watching", 6e9)), {}),
              HasSubstr("generation 4, on probation\n"));
}

TEST(RenderPending, NamesTheUserAndTheReasonOfALock) {
  auto status = with(
      "locked", {{"uid", 987654}, {"time", "2026-01-31T12:00:00.123456Z"}, {"reason", "mission"}});
  status["lock"] = "all";
  EXPECT_EQ(render_pending(status, {}), "all locked by 987654 at 2026-01-31 12:00:00Z: mission\n");
  EXPECT_EQ(render_pending(with("locked", nullptr), {}), "");
}

TEST(RenderPending, CountsDownToAConfirmation) {
  EXPECT_THAT(render_pending(with("probations", probation("awaits_confirmation", 2e9)), {}),
              HasSubstr("goes back in 2 s unless somebody confirms it: mauvectl confirm"));
}

TEST(RenderPending, SaysThatTheFileWasNotStarted) {
  EXPECT_THAT(render_pending(with("recovered", 42), {}),
              HasSubstr("began with generation 42 after a crash or an upgrade, not with its file"));
}

TEST(RenderPending, CountsCoresInQuarantine) {
  EXPECT_EQ(render_pending(with("quarantine", 2), {}),
            "2 cores are in quarantine: mauvectl quarantine\n");
}

TEST(RenderPending, NamesComponentsWhoseValuesAreNotPlausible) {
  Json status = Json::parse(R"({"generation": 4, "architecture": "a", "components": [
      {"name": "arm", "state": "running", "implausible": 1},
      {"name": "leg", "state": "running", "implausible": 0}]})");

  const std::string text = render_status(status, {});

  EXPECT_THAT(text, testing::HasSubstr("\narm: 1 value of its present core was not plausible, so "
                                       "no reader gets it: mauvectl why arm\n"));
  EXPECT_THAT(text, testing::Not(testing::HasSubstr("leg: ")));
}

}  // namespace
}  // namespace mauve::ctl
