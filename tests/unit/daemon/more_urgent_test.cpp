// SPDX-License-Identifier: LGPL-3.0-or-later
// The components to which `why` of a late component leads.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>

#include "commands/measure/more_urgent.h"

namespace mauve::daemon {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;

/// A real-time component on CPU 1 with a period of 10 ms and jobs of 1 ms.
ComponentStatus component(const char* name, int priority) {
  ComponentStatus status;
  status.name = name;
  status.priority = priority;
  status.cpus = {1};
  status.realtime = true;
  status.period = 10ms;
  status.elapsed_max = status.used_max = 1ms;
  return status;
}

/// The same, with a budget of 2 ms that jobs exceeded.
ComponentStatus hog(const char* name, int priority, Duration used) {
  auto status = component(name, priority);
  status.budget = 2ms;
  status.over_budget = 9;
  status.over_present_budget = 7;
  status.elapsed_max = status.used_max = used;
  return status;
}

TEST(WhyOfALateComponent, LeadsToMoreUrgentOnesThatExceededTheirBudgetTheWorstFirst) {
  const auto victim = component("victim", 40);

  const auto hints =
      more_urgent_hints(victim, {victim, hog("small", 50, 3ms), hog("large", 60, 9ms)});

  EXPECT_THAT(hints,
              ElementsAre("mauvectl why large: it is more urgent on the same CPU, and 7 "
                          "jobs exceeded its budget of 2.0 ms (longest 9.0 ms of processor time)",
                          "mauvectl why small: it is more urgent on the same CPU, and 7 "
                          "jobs exceeded its budget of 2.0 ms (longest 3.0 ms of processor time)"));
}

TEST(WhyOfALateComponent, LeadsToNoneThatCannotHaveDelayedIt) {
  const auto victim = component("victim", 40);
  auto elsewhere = hog("elsewhere", 60, 9ms);
  elsewhere.cpus = {0};
  auto ordinary = hog("ordinary", 60, 9ms);
  ordinary.realtime = false;
  auto preempted = hog("preempted", 60, 1ms);
  preempted.elapsed_max = 9ms;  // on the clock only

  EXPECT_THAT(more_urgent_hints(victim, {victim, elsewhere, ordinary, preempted,
                                         hog("less_urgent", 30, 9ms), component("sound", 60)}),
              IsEmpty());
}

TEST(WhyOfALateComponent, LeadsFirstToOneWhoseJobDoesNotEnd) {
  const auto victim = component("victim", 40);
  auto hanging = component("hanging", 40);
  hanging.late = 5s;

  const auto hints = more_urgent_hints(victim, {hog("large", 60, 9ms), hanging, victim});

  ASSERT_EQ(hints.size(), 2U);
  EXPECT_EQ(hints[0],
            "mauvectl why hanging: it is as urgent on the same CPU, and its job should have ended "
            "5.0 s ago");
}

TEST(WhyOfALateComponent, LeadsToOneWhoseJobsAreLongIfNoneExceededABudget) {
  const auto victim = component("victim", 40);
  auto longer = component("long", 60);
  longer.elapsed_max = longer.used_max = 9500us;

  EXPECT_THAT(more_urgent_hints(victim, {victim, longer, component("sound", 50)}),
              ElementsAre("mauvectl why long: it is more urgent on the same CPU, and its longest "
                          "job (9.5 ms of processor time, no budget) leaves too little of a period "
                          "of 10.0 ms"));
}

TEST(WhyOfALateComponent, LeadsToNoneWhoseJobsExceededOnlyAFormerBudget) {
  const auto victim = component("victim", 40);
  auto changed = hog("changed", 60, 3ms);
  changed.over_present_budget = 0;

  EXPECT_THAT(more_urgent_hints(victim, {victim, changed}), IsEmpty());
}

TEST(WhyOfALateComponent, BlamesItsOwnJobIfThatAloneIsTooLong) {
  const auto safety = component("safety", 60);
  auto arm = component("arm", 40);
  arm.used_max = 49'729us;
  EXPECT_THAT(more_urgent_hints(arm, {arm, safety}),
              ElementsAre("mauvectl stats arm: its own job is too long: up to 49.7 ms of "
                          "processor time, its period is 10.0 ms"));

  arm.used_max = 9500us;
  arm.budget = 500us;
  EXPECT_THAT(more_urgent_hints(arm, {arm, safety}),
              ElementsAre("mauvectl stats arm: its own job is too long: up to 9.5 ms of "
                          "processor time, its budget is 500 us"));
}

TEST(WhyOfALateComponent, StillLeadsToOnesThatExceededTheirBudgetIfItsOwnJobIsTooLong) {
  auto arm = component("arm", 40);
  arm.used_max = 12ms;

  const auto hints = more_urgent_hints(arm, {arm, hog("large", 60, 9ms), component("sound", 60)});

  ASSERT_EQ(hints.size(), 2U);
  EXPECT_THAT(hints[0], testing::StartsWith("mauvectl stats arm: its own job"));
  EXPECT_THAT(hints[1], testing::StartsWith("mauvectl why large: "));
}

TEST(WhyOfALateComponent, SaysFirstThatItsThreadIsAnOrdinaryOne) {
  auto control = component("control", 40);
  control.realtime = false;

  EXPECT_THAT(more_urgent_hints(control, {control, component("sound", 60)}),
              ElementsAre("mauvectl doctor: this component runs on an ordinary thread, which other "
                          "programs delay"));
}

}  // namespace
}  // namespace mauve::daemon
