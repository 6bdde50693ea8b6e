// SPDX-License-Identifier: LGPL-3.0-or-later
#include "analysis/relaxation.h"

#include <random>

#include <gtest/gtest.h>

#include "analysis/admission.h"
#include "base/duration.h"
#include "task_sets.h"

namespace mauve::analysis {
namespace {

bool passes(const TaskSet& set) { return problems(analyze(set)).empty(); }

/// As a message shows it to users, who write it into a file.
Duration as_printed(Duration time) { return *parse_duration(format_duration(time)); }

TEST(Relaxation, WhatItNamesPassesForTheWholeSetAsItIsPrinted) {
  std::mt19937 random(7);
  const auto in = [&](int low, int high) {
    return std::uniform_int_distribution<int>(low, high)(random);
  };
  int named = 0;
  for (int i = 0; i < 300; ++i) {
    std::vector<Task> tasks;
    for (int priority = 1; priority <= 4; ++priority) {
      const Duration period = in(3, 40) * 1ms;
      tasks.push_back(task("t" + std::to_string(priority), priority, period,
                           period * in(5, 45) / 100 + in(0, 999) * 1ns));
    }
    const TaskSet refused = set(tasks);
    if (passes(refused)) continue;
    for (const Task& one : tasks) {
      int asked = 0;
      const auto time = passing_execution(refused, one.name, [&](const TaskSet& other) {
        ++asked;
        return passes(other);
      });
      EXPECT_LE(asked, 16);
      EXPECT_EQ(time.has_value(), passes(with_execution(refused, one.name, 1us)));
      if (!time) continue;
      ++named;
      EXPECT_TRUE(passes(with_execution(refused, one.name, as_printed(*time)))) << one.name;
      const Duration step = one.graph.vertices[0].execution / 4000 + *time / 50;
      EXPECT_FALSE(passes(with_execution(refused, one.name, *time + step)))
          << "it is about the longest";
    }
  }
  EXPECT_GT(named, 50);
}

TEST(Relaxation, CountsAResourceThatIsHeldForAWholeJob) {
  Task low = task("low", 1, 100ms, 40ms);
  low.sections.push_back({"r", 40ms, Source::unknown});
  Task high = task("high", 2, 10ms, 2ms);
  high.sections.push_back({"r", 1ms, Source::declared});

  const auto time = passing_execution(set({low, high}), "low", passes);

  ASSERT_TRUE(time);
  EXPECT_LE(*time, 8ms) << "high waits for it";
}

TEST(Relaxation, NamesNothingWhereNothingWouldPass) {
  const TaskSet refused = set({task("a", 1, 10ms, 11ms), task("b", 2, 20ms, 1ms)});

  EXPECT_FALSE(passing_execution(refused, "b", passes));
  EXPECT_FALSE(passing_execution(refused, "nobody", passes));
}

}  // namespace
}  // namespace mauve::analysis
