// SPDX-License-Identifier: LGPL-3.0-or-later
/// Response times: examples of textbooks, to the nanosecond.
#include <gtest/gtest.h>

#include "task_sets.h"

namespace mauve::analysis {
namespace {

std::vector<Duration> responses(const Report& report) {
  std::vector<Duration> result;
  for (const TaskReport& one : report.tasks) result.push_back(one.jobs.front().response);
  return result;
}

TEST(Response, OfThreePeriodicTasksIsThatOfTheTextbook) {  // Burns and Wellings
  const Report report =
      analyze(set({task("a", 3, 7ms, 3ms), task("b", 2, 12ms, 3ms), task("c", 1, 20ms, 5ms)}));

  EXPECT_EQ(responses(report), (std::vector<Duration>{3ms, 6ms, 20ms}));
  EXPECT_EQ(report.tasks[2].jobs[0].slack(), 0ms);
  EXPECT_NEAR(report.cpus[0].load, 3.0 / 7 + 3.0 / 12 + 5.0 / 20, 1e-9);
}

TEST(Response, HarmonicPeriodsMayUseAllOfTheProcessor) {
  const Report report =
      analyze(set({task("c", 3, 20ms, 5ms), task("b", 2, 40ms, 10ms), task("a", 1, 80ms, 40ms)}));

  EXPECT_EQ(responses(report), (std::vector<Duration>{5ms, 15ms, 80ms}));
  EXPECT_TRUE(report.cpus[0].overloaded) << "the kernel stops what takes a whole second";
}

TEST(Response, OfTwoTasksAboveTheLiuAndLaylandBoundMayBeTooLong) {
  // 5/10 + 6/14 = 0.929, above 0.828: the second is late, 6 + 5 + 5 = 16 > 14.
  const Report report = analyze(set({task("a", 2, 10ms, 5ms), task("b", 1, 14ms, 6ms)}));

  ASSERT_TRUE(report.tasks[1].late());
  EXPECT_FALSE(report.tasks[0].late());
  EXPECT_EQ(report.tasks[1].jobs[0].needed_deadline(), 0ms) << "16 ms is after the next release";
  EXPECT_EQ(report.tasks[1].jobs[0].needed_execution, 5ms);
}

TEST(Response, CountsEqualPrioritiesAsHigherOnes) {
  const Report report = analyze(set({task("a", 1, 10ms, 2ms), task("b", 1, 10ms, 3ms)}));

  EXPECT_EQ(responses(report), (std::vector<Duration>{5ms, 5ms}));
}

TEST(Response, WithBlockingByALowerTaskThatHoldsAResource) {
  Task a = task("a", 3, 10ms, 2ms);
  Task b = task("b", 2, 20ms, 4ms);
  Task c = task("c", 1, 50ms, 9ms);
  a.sections = {{"map", 1ms}};
  c.sections = {{"map", 3ms}};

  const Report report = analyze(set({a, b, c}));

  EXPECT_EQ(responses(report), (std::vector<Duration>{5ms, 9ms, 17ms}));
  EXPECT_EQ(report.tasks[0].blocking, 3ms);
  EXPECT_EQ(report.tasks[2].blocking, 0ms);
}

TEST(Response, WithJitterOfAHigherTask) {
  Task a = task("a", 2, 10ms, 3ms);
  a.jitter = 2ms;

  const Report report = analyze(set({a, task("b", 1, 20ms, 6ms)}));

  // 6 + 3 = 9; two releases of a fit into 9 ms when the first comes 2 ms late: 6 + 3 + 3.
  EXPECT_EQ(responses(report), (std::vector<Duration>{5ms, 12ms}));
}

TEST(Response, WithOverheadsOfTheMachine) {
  const Report report = analyze({{task("a", 2, 10ms, 1ms), task("b", 1, 10ms, 2ms)}, {}});

  // wake-up 60, two switches of 3, one timer for both, one tick each 4 ms
  EXPECT_EQ(responses(report), (std::vector<Duration>{1108us, 3111us}));
}

TEST(Response, CountsTimersOneByOneWhenTheGridIsFine) {
  Overheads overheads = no_overheads();
  overheads.interrupt = 100us;

  const Report report =
      analyze({{task("a", 2, 10ms, 1ms), task("b", 1, 10'001us, 1ms)}, overheads});

  // The grid is 1 us, but only two timers expire.
  EXPECT_EQ(responses(report), (std::vector<Duration>{1200us, 2200us}));
}

TEST(Response, OfAStateMachineIsGivenForEachJob) {
  Task walker = task("walker", 1, 10ms, 0ms);
  walker.graph.vertices = {{"fast", "slow", 1ms, 10ms, Source::declared, Part::steady},
                           {"slow", "fast", 6ms, 30ms, Source::measured, Part::steady}};
  walker.graph.edges = {{0, 1, 10ms}, {1, 0, 30ms}};

  const Report report = analyze(set({task("top", 2, 8ms, 4ms), walker}));

  ASSERT_EQ(report.tasks[1].jobs.size(), 2u);
  EXPECT_EQ(report.tasks[1].jobs[0].response, 5ms);
  EXPECT_EQ(report.tasks[1].jobs[1].response, 14ms);
  EXPECT_EQ(report.tasks[1].source, Source::measured);
}

TEST(Response, AJobWithoutWorkStillWaitsForOthers) {
  const Report report = analyze(set({task("a", 2, 10ms, 4ms), task("b", 1, 10ms, 0ms)}));

  EXPECT_EQ(responses(report), (std::vector<Duration>{4ms, 4ms}));
}

TEST(Response, IsNotBoundedWhenHigherTasksTakeEverything) {
  const Report report = analyze(set({task("a", 2, 10ms, 10ms), task("b", 1, 100ms, 1ms)}));

  EXPECT_EQ(responses(report)[1], kUnbounded);
  EXPECT_LE(report.tasks[1].jobs[0].needed_execution, 0ms);
}

TEST(Response, ADeadlineAfterTheNextReleaseDoesNotCount) {
  Task late = task("late", 1, 10ms, 1ms);
  late.graph.vertices[0].deadline = 1s;

  EXPECT_EQ(analyze(set({late})).tasks[0].jobs[0].deadline, 10ms);
}

}  // namespace
}  // namespace mauve::analysis
