// SPDX-License-Identifier: LGPL-3.0-or-later
/// The main job on a noisy machine. Strict admission starts the shipped rover every time. A core on
/// probation is judged by its own time, alone and beside neighbours that take all the time they can
/// get.
///
/// Compiled twice: a short form, and a campaign (MAUVE_WHOLE) that also drives the demo.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <string>

#include "rt/thread/thread.h"
#include "support/daemon_process.h"
#include "support/neighbours.h"
#include "trial_daemon.h"

namespace mauve::test {
namespace {

using testing::HasSubstr;

#ifdef MAUVE_WHOLE
/// MAUVE_CAMPAIGN_SECONDS shortens the campaign, of which 600 are the whole.
int shortened(int whole) {
  const char* said = std::getenv("MAUVE_CAMPAIGN_SECONDS");
  return said == nullptr ? whole : std::max(1, whole * std::atoi(said) / 600);
}
const int kStarts = shortened(100);
const int kTries = shortened(50);
const int kDemos = shortened(20);
#else
constexpr int kStarts = 3;
constexpr int kTries = 2;
#endif

bool no_realtime() { return !rt::may_use_fifo(99).has_value(); }
constexpr const char* kSkipped = "NOT TESTED: no SCHED_FIFO here";

void start_the_rover(int count) {
  for (int i = 0; i < count; ++i) {
    DaemonProcess rover(MAUVE_SOURCE_DIR "/etc/rover.json", {"--admission", "strict"});
    EXPECT_TRUE(rover.up()) << "start " << i << ": " << rover.errors();
    rover.process().signal(SIGKILL);  // its trace would show the neighbours
  }
}

TEST(StrictStart, OfTheShippedRoverSucceedsEveryTime) { start_the_rover(kStarts); }

TEST(StrictStart, OfTheShippedRoverSucceedsEveryTimeBesideNeighbours) {
  if (no_realtime()) GTEST_SKIP() << kSkipped;
  Neighbours neighbours;
  ASSERT_TRUE(neighbours.running());
  start_the_rover(kStarts);
}

/// One component of 100 Hz that may use 300 us a job.
constexpr const char* kBudgeted = R"({
  "schema": "mauve/architecture/1", "name": "budgeted", "plugins": ["trial"],
  "resources": { "signal": { "type": "shared_data", "data": "double" } },
  "components": {
    "first": { "type": "trial/unit", "properties": { "fsm.period": "10ms" },
               "ports": { "output": "signal.write" },
               "task": { "priority": 40, "cpus": [0], "budget": "300us" } }
  }
})";

/// A change to the core that works for so long, which is on probation for so many jobs. "hungry"
/// measures its processor time, "hard_working" does work that takes so long on an idle processor.
Json swap_to(const std::string& core, const std::string& uses, const std::string& jobs) {
  return {{"component", "first"},
          {"core", "trial/" + core},
          {"set", {{"uses", uses}}},
          {"probation", jobs}};
}

/// The end of its probation, as the log reports it; empty: it goes on.
std::string end_of_probation(TrialDaemon& daemon) {
  std::string end;
  static_cast<void>(eventually([&] {
    const auto log = daemon.ask("log.tail", {{"n", 1000}});
    for (const auto& record : log["records"]) {
      const std::string event = record["event"];
      if (event == "rolled_back" || event == "probation_passed") end = record["text"];
    }
    return !end.empty();
  }));
  return end;
}

void catch_a_core_a_fifth_over_its_budget(int tries) {
  for (int i = 0; i < tries; ++i) {
    TrialDaemon daemon(kBudgeted, {});
    ASSERT_EQ(daemon.ask("core.swap", swap_to("hungry", "360us", "1000"))["state"], "applied");
    EXPECT_THAT(end_of_probation(daemon), HasSubstr("took longer than its budget")) << "try " << i;
    daemon.process().signal(SIGKILL);
  }
}

void leave_a_core_within_its_budget_alone(int tries) {
  for (int i = 0; i < tries; ++i) {
    TrialDaemon daemon(kBudgeted, {});
    ASSERT_EQ(daemon.ask("core.swap", swap_to("hard_working", "150us", "200"))["state"], "applied");
    EXPECT_THAT(end_of_probation(daemon), HasSubstr("200 jobs without a fault")) << "try " << i;
    daemon.process().signal(SIGKILL);
  }
}

TEST(Blame, CatchesACoreAFifthOverItsBudget) {
  if (no_realtime()) GTEST_SKIP() << kSkipped;
  catch_a_core_a_fifth_over_its_budget(kTries);
}

TEST(Blame, CatchesACoreAFifthOverItsBudgetBesideNeighbours) {
  if (no_realtime()) GTEST_SKIP() << kSkipped;
  Neighbours neighbours;
  ASSERT_TRUE(neighbours.running());
  catch_a_core_a_fifth_over_its_budget(kTries);
}

TEST(Blame, LeavesACoreWithinItsBudgetAlone) {
  if (no_realtime()) GTEST_SKIP() << kSkipped;
  leave_a_core_within_its_budget_alone(kTries);
}

TEST(Blame, LeavesACoreWithinItsBudgetAloneBesideNeighbours) {
  if (no_realtime()) GTEST_SKIP() << kSkipped;
  Neighbours neighbours;
  ASSERT_TRUE(neighbours.running());
  leave_a_core_within_its_budget_alone(kTries);
}

#ifdef MAUVE_WHOLE
void drive_the_demo(int count) {
  for (int i = 0; i < count; ++i) {
    const TempDir place;
    setenv("MAUVE_BIN", MAUVE_BIN_DIR, 1);
    setenv("MAUVE_PLUGINS", MAUVE_PLUGIN_DIR, 1);
    setenv("MAUVE_DEMO_OUT", place.path().c_str(), 1);
    const std::string errors = (place / "errors.txt").string();
    Process demo({MAUVE_SOURCE_DIR "/scripts/demo.d/rover"}, errors);
    const std::string said = demo.all_output();
    EXPECT_EQ(demo.wait(), 0) << "drive " << i << ": " << said << TempDir::read(errors)
                              << TempDir::read(place / "mauved.log");
  }
}

TEST(Demo, DrivesToItsGoalEveryTime) { drive_the_demo(kDemos); }

TEST(Demo, DrivesToItsGoalEveryTimeBesideNeighbours) {
  Neighbours neighbours;
  ASSERT_TRUE(neighbours.running());
  drive_the_demo(kDemos);
}
#endif

}  // namespace
}  // namespace mauve::test
