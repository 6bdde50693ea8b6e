// SPDX-License-Identifier: LGPL-3.0-or-later
/// The treatment of releases that come too late. The core itself moves the manual clock.
#include <gtest/gtest.h>

#include "exec/task/task.h"
#include "exec/update/task_update.h"

#include <mauve/host/component.h>
#include <mauve/plugin.h>

namespace mauve::exec {
namespace {

/// Job number n takes `cost(n)` of the manual clock.
class Busy : public Core<EmptyShell> {
 public:
  void update() {
    released.push_back(clock->now());
    steps.push_back(time_step());
    const std::size_t job = released.size() - 1;
    if (job < costs.size()) clock->advance(costs[job]);
  }
  ManualClock* clock = nullptr;
  std::vector<Duration> costs;
  std::vector<Instant> released;
  std::vector<Duration> steps;
};

class Overrun : public testing::Test {
 protected:
  Overrun() {
    component = std::make_unique<ComponentBase>(
        "busy",
        ComponentType{"busy", ShellType::of<EmptyShell>(),
                      FsmType::of<PeriodicFsm<Busy>>("periodic"), ""},
        CoreType::of<Busy>("busy"));
    static_cast<PeriodicFsm<Busy>&>(component->fsm()).period = 1ms;
  }

  void begin() {
    ASSERT_TRUE(component->configure());
    core().clock = &clock;
    auto first = std::make_unique<TaskUpdate>();
    first->bundle = component->bundle();
    first->shortest_wait = component->fsm().shortest_wait();
    task.begin(std::move(first), kT0);
  }
  Busy& core() { return static_cast<Busy&>(component->core()); }
  /// Runs `count` jobs, each when it is due or at once.
  void run(int count) {
    for (int i = 0; i < count && task.running(); ++i) {
      clock.set(std::max(clock.now(), task.next_release()));
      task.run_release();
    }
  }
  /// Of the events since the last call; `log`: there was none.
  rt::EventKind last_overrun() {
    rt::EventKind last = rt::EventKind::log;
    rt::Event event;
    while (task.report().events().pop(event)) {
      const bool overrun = event.kind == rt::EventKind::overrun;
      if (overrun || event.kind == rt::EventKind::long_overrun) last = event.kind;
    }
    return last;
  }
  std::vector<std::int64_t> released_ms() {
    std::vector<std::int64_t> all;
    for (const Instant instant : core().released) all.push_back((instant - kT0) / 1'000'000);
    return all;
  }

  static constexpr Instant kT0 = 1'000'000'000;
  ManualClock clock{kT0};
  std::unique_ptr<ComponentBase> component;
  Task task{"busy", clock};
};

TEST_F(Overrun, SkipRunsTheNewestMissedReleaseAndStaysOnTheGrid) {
  begin();
  core().costs = {0ms, 5500us};

  run(4);

  EXPECT_EQ(released_ms(), (std::vector<std::int64_t>{0, 1, 6, 7}));
  EXPECT_EQ(task.counters().missed, 4u) << "releases 2, 3, 4 and 5 never ran";
  EXPECT_EQ(task.counters().overruns, 1u);
  EXPECT_EQ((task.next_release() - kT0) % 1'000'000, 0);
}

TEST_F(Overrun, TheTimeStepOfAJobGoesFromReleaseToRelease) {
  begin();
  core().costs = {300us, 5500us};

  run(4);

  EXPECT_EQ(core().steps, (std::vector<Duration>{1ms, 1ms, 5ms, 1ms}))
      << "the first job, an exact period, and four missed releases";
  EXPECT_EQ(time_step(), 0ms) << "outside a job";
}

TEST_F(Overrun, CatchUpRunsEveryMissedReleaseBackToBack) {
  component->task().on_overrun = OnOverrun::catch_up;
  begin();
  core().costs = {0ms, 3500us};

  run(6);

  EXPECT_EQ(released_ms(), (std::vector<std::int64_t>{0, 1, 4, 4, 4, 5}));
  EXPECT_EQ(task.counters().missed, 0u);
}

TEST_F(Overrun, TheLimitIsOneOfTheLastSixtyFourJobs) {
  component->task().on_overrun = OnOverrun::stop;
  component->task().overrun_limit = 2;
  begin();
  core().costs.resize(200);
  core().costs[0] = core().costs[64] = core().costs[128] = 1500us;

  run(150);
  EXPECT_EQ(task.counters().overruns, 3u);
  EXPECT_EQ(task.counters().state, ComponentState::running) << "each is 64 jobs after the last";

  core().costs[150] = 1500us;
  run(5);
  EXPECT_EQ(task.counters().state, ComponentState::stopped) << "22 jobs after the last";
}

TEST_F(Overrun, StopEndsTheComponentAfterItsLimit) {
  component->task().on_overrun = OnOverrun::stop;
  component->task().overrun_limit = 2;
  begin();
  core().costs = {1500us, 1500us, 1500us};

  run(5);

  EXPECT_EQ(core().released.size(), 2u);
  EXPECT_FALSE(task.running());
  EXPECT_EQ(task.counters().state, ComponentState::stopped);
}

TEST_F(Overrun, LateWakeUpWithinThePeriodIsNoOverrun) {
  begin();
  clock.advance(900us);

  task.run_release();

  EXPECT_EQ(task.counters().overruns, 0u);
  EXPECT_EQ(task.counters().lateness_max, 900'000);
}

TEST_F(Overrun, DeadlineBeforeTheEndOfTheWaitCounts) {
  component->task().deadline = 300us;
  begin();
  core().costs = {400us, 200us};

  run(2);

  EXPECT_EQ(task.counters().overruns, 1u);
  EXPECT_EQ(task.counters().missed, 0u);
}

TEST_F(Overrun, BudgetIsReportedAndChangesNothing) {
  component->task().budget = 100us;
  begin();
  core().costs = {150us, 50us};

  run(2);

  EXPECT_EQ(task.counters().over_budget, 1u);
  EXPECT_EQ(task.counters().over_present_budget, 1u);
  EXPECT_EQ(component->bundle()->measured->shown().over_budget_max, 150'000);
  EXPECT_TRUE(task.running());
}

TEST_F(Overrun, OfAJobThatTookTooLongIsAnotherEventThanThatOfOneThatBeganLate) {
  begin();
  core().costs = {1500us, 0us, 200us};
  run(2);
  EXPECT_EQ(last_overrun(), rt::EventKind::long_overrun);

  clock.set(task.next_release() + Instant{900'000});
  task.run_release();
  EXPECT_EQ(last_overrun(), rt::EventKind::overrun);
  EXPECT_EQ(task.counters().overruns, 2u);
}

TEST_F(Overrun, OffsetShiftsAllReleases) {
  component->task().offset = 250us;
  begin();

  run(3);

  EXPECT_EQ(core().released[0] - kT0, 250'000);
  EXPECT_EQ(core().released[2] - kT0, 2'250'000);
}

TEST_F(Overrun, IsNoneWhileATaskDoesNotRun) {
  component->task().start = false;
  begin();

  EXPECT_GT(task.known_release(), clock.now() + Duration{1h}.count()) << "nothing is overdue";
}

TEST_F(Overrun, IsJudgedByTheReleaseThatATaskReportsToItsGuard) {
  begin();
  EXPECT_EQ(task.known_release(), kT0);

  run(2);

  EXPECT_EQ(task.known_release(), kT0 + Duration{2ms}.count());
}

}  // namespace
}  // namespace mauve::exec
