// SPDX-License-Identifier: LGPL-3.0-or-later
#include "analysis/admission.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "task_sets.h"

namespace mauve::analysis {
namespace {

/// The only problem of a report; fails when there are more or none.
Problem only_problem(const Report& report) {
  const std::vector<Problem> found = problems(report);
  EXPECT_EQ(found.size(), 1u);
  for (const Problem& problem : found) SCOPED_TRACE(to_string(problem.error));
  return found.empty() ? Problem{} : found.front();
}

TEST(Analyze, ProvesWhatIsInTime) {
  const Report report = analyze(set({task("a", 2, 10ms, 2ms), task("b", 1, 20ms, 5ms)}));

  EXPECT_TRUE(report.proven());
  EXPECT_TRUE(problems(report).empty());
}

TEST(Analyze, OfNothingIsProven) { EXPECT_TRUE(analyze({}).proven()); }

TEST(Analyze, NamesTheTaskThatIsLateAndWhatWouldPass) {
  Task late = task("control", 1, 20ms, 5ms);
  late.graph.vertices[0].deadline = 15ms;

  const Problem problem =
      only_problem(analyze(set({task("a", 3, 7ms, 3ms), task("b", 2, 12ms, 3ms), late})));

  EXPECT_EQ(problem.kind, Problem::Kind::late);
  EXPECT_EQ(problem.error.at, "control");
  EXPECT_EQ(problem.error.message,
            "its job from period to period may end 20ms after its release, its deadline is 15ms");
  EXPECT_EQ(problem.error.hint, "a deadline of 20ms or an execution time of 3ms would pass");
}

TEST(Analyze, WhatItSaysWouldPassDoesPass) {
  const std::vector<Task> above{task("a", 3, 7ms, 3ms), task("b", 2, 12ms, 3ms)};
  Task late = task("control", 1, 20ms, 5ms);
  late.graph.vertices[0].deadline = 15ms;
  const auto passes = [&](Duration deadline, Duration execution) {
    late.graph.vertices[0].deadline = deadline;
    late.graph.vertices[0].execution = execution;
    return analyze(set({above[0], above[1], late})).passes();
  };
  const Report refused = analyze(set({above[0], above[1], late}));
  const JobReport needs = refused.tasks[2].jobs[0];

  EXPECT_TRUE(passes(needs.needed_deadline(), 5ms));
  EXPECT_FALSE(passes(needs.needed_deadline() - 1ns, 5ms));
  EXPECT_TRUE(passes(15ms, needs.needed_execution));
  EXPECT_FALSE(passes(15ms, needs.needed_execution + 1ns));
}

TEST(Analyze, LeavesFivePercentOfASecondToTheKernel) {
  EXPECT_TRUE(analyze(set({task("a", 1, 10ms, 9500us)})).passes());

  const Problem problem = only_problem(analyze(set({task("a", 1, 10ms, 9600us)})));

  EXPECT_EQ(problem.kind, Problem::Kind::overloaded);
  EXPECT_EQ(problem.error.at, "cpu 0");
  EXPECT_EQ(problem.error.message,
            "its tasks may ask for 960ms of its time in a second, 950ms are allowed");
}

TEST(Analyze, SaysThatAnExecutionTimeIsNotKnown) {
  Task unknown = task("a", 1, 10ms, 0ms);
  unknown.graph.vertices[0].source = Source::unknown;

  const Report report = analyze(set({unknown}));

  EXPECT_TRUE(report.passes());
  EXPECT_FALSE(report.proven());
  EXPECT_EQ(only_problem(report).kind, Problem::Kind::unknown);
  EXPECT_EQ(only_problem(report).error.at, "a");
}

TEST(Analyze, SaysThatATaskFloatsAndCountsItOnEachCpu) {
  Task floats = task("floats", 2, 10ms, 3ms);
  floats.cpu.reset();
  Task a = task("a", 1, 10ms, 1ms);
  Task b = a;
  b.name = "b";
  b.cpu = 1;

  const Report report = analyze(set({floats, a, b}));

  EXPECT_EQ(only_problem(report).kind, Problem::Kind::floating);
  ASSERT_EQ(report.tasks.size(), 3u);
  EXPECT_EQ(report.tasks[0].jobs[0].response, 4ms);
  EXPECT_EQ(report.tasks[1].jobs[0].response, 4ms);
  EXPECT_EQ(report.tasks[2].name, "floats");
}

TEST(Analyze, SaysThatALockIsSharedAcrossCpus) {
  Task a = task("a", 1, 10ms, 1ms);
  Task b = task("b", 1, 10ms, 1ms);
  b.cpu = 1;
  a.sections = b.sections = {{"map", 10us}};

  const Report report = analyze(set({a, b}));

  const Problem problem = only_problem(report);
  EXPECT_EQ(problem.kind, Problem::Kind::cross_cpu);
  EXPECT_EQ(problem.error.at, "map");
  EXPECT_EQ(report.cross_cpu[0].tasks, (std::vector<std::string>{"a", "b"}));
}

TEST(Analyze, KeepsCpusApart) {
  Task other = task("other", 9, 10ms, 9ms);
  other.cpu = 1;

  const Report report = analyze(set({task("a", 1, 10ms, 9ms), other}));

  EXPECT_TRUE(report.proven());
  EXPECT_EQ(report.cpus.size(), 2u);
}

TEST(Admit, RefusesACoreThatIsTooSlowAndNamesWhoWouldBeLate) {
  const TaskSet before = set({task("fast", 2, 10ms, 2ms), task("slow", 1, 20ms, 8ms)});
  TaskSet after = before;
  after.tasks[0].graph = periodic(10ms, 7ms);

  const Report report = admit(before, after);

  EXPECT_FALSE(report.passes());
  const std::vector<Problem> found = problems(report);
  EXPECT_TRUE(std::any_of(found.begin(), found.end(), [](const Problem& problem) {
    return problem.kind == Problem::Kind::late && problem.error.at == "slow";
  }));
}

TEST(Admit, CountsTheWorkOfTakingTheChange) {
  TaskSet before = set({task("a", 1, 10ms, 9ms)});
  before.overheads.change = 500us;
  TaskSet after = before;
  EXPECT_TRUE(admit(before, after).passes()) << "nothing changes";

  after.tasks[0].version = 1;
  EXPECT_TRUE(admit(before, after).passes());
  before.overheads.change = after.overheads.change = 1001us;

  const Problem problem = only_problem(admit(before, after));
  EXPECT_NE(problem.error.message.find("(first after the change)"), std::string::npos)
      << problem.error.message;
}

TEST(Admit, RefusesAChangeWhoseRollbackWouldBeLate) {
  const TaskSet heavy = set({task("a", 2, 10ms, 9ms)});
  const TaskSet light = set({task("a", 2, 10ms, 1ms)});
  TaskSet before = heavy;
  TaskSet after = light;
  before.overheads.change = after.overheads.change = 1500us;

  const Problem problem = only_problem(admit(before, after));

  EXPECT_NE(problem.error.message.find("(first after a rollback)"), std::string::npos);
}

TEST(Admit, LetsOneTaskTakeThePlaceOfAnotherThoughBothWouldBeTooMuch) {
  const Task stays = task("stays", 1, 200ms, 100ms);
  const TaskSet before = set({task("old", 2, 10ms, 3ms), stays});
  const TaskSet after = set({task("new", 2, 10ms, 3ms), stays});
  TaskSet both = before;
  both.tasks.push_back(after.tasks[0]);
  ASSERT_FALSE(analyze(both).passes());

  const Report report = admit(before, after);

  EXPECT_TRUE(report.passes()) << to_string(problems(report).front().error);
  // 100 of its own, 16 jobs above it, and one more at each of two changes.
  EXPECT_EQ(report.tasks.back().name, "stays");
  EXPECT_EQ(report.tasks.back().jobs[0].response, 154ms);
}

TEST(Admit, ChecksAnAddedTaskAndThoseBelowIt) {
  const TaskSet before = set({task("a", 1, 10ms, 6ms)});
  TaskSet after = before;
  after.tasks.push_back(task("new", 2, 10ms, 5ms));

  EXPECT_FALSE(admit(before, after).passes());
  EXPECT_EQ(problems(admit(before, after)).front().error.at, "a");
}

TEST(LargestFactor, IsWhereTheFirstTaskIsLateOrTheCpuFull) {
  EXPECT_NEAR(largest_factor(set({task("a", 1, 10ms, 5ms)})), 1.9, 0.02);
  // 3 f + 3 f + 5 f within 20 ms, with three of a and two of b: just now.
  const TaskSet full =
      set({task("a", 3, 7ms, 3ms), task("b", 2, 12ms, 3ms), task("c", 1, 20ms, 5ms)});
  EXPECT_NEAR(largest_factor(full), 1.0, 0.01);
}

TEST(LargestFactor, IsBelowOneForARefusedSet) {
  EXPECT_NEAR(largest_factor(set({task("a", 2, 10ms, 5ms), task("b", 1, 14ms, 6ms)})), 10.0 / 11,
              0.01);
}

TEST(LargestFactor, OfAProcessorThatTheMachineAloneFillsIsZero) {
  TaskSet hopeless = set({task("a", 1, 10ms, 1ms)});
  hopeless.overheads.wake = 11ms;

  EXPECT_EQ(largest_factor(hopeless), 0);
}

}  // namespace
}  // namespace mauve::analysis
