// SPDX-License-Identifier: LGPL-3.0-or-later
/// The times of jobs and states, on a clock that is moved by hand. Another thread may really
/// preempt a job, so clean and preempted jobs are counted together.
#include <gtest/gtest.h>

#include <future>
#include <thread>

#include "exec/task/task.h"
#include "exec/update/task_update.h"
#include "rt/thread/preemption.h"
#include "support/eventually.h"
#include "support/ramp.h"

#include <mauve/detail/resource_lock.h>
#include <mauve/plugin.h>

namespace mauve::exec {
namespace {

/// Its states take time of the manual clock.
class Walker : public Core<EmptyShell> {
 public:
  void look() { clock->advance(100us); }
  void go() { clock->advance(steps++ % 2 == 0 ? 200us : 300us); }
  ManualClock* clock = nullptr;
  int steps = 0;
};

/// look, go, and a wait.
struct Walking : Fsm<Walker> {
  Exec look{*this, "look", &Walker::look};
  Exec go{*this, "go", &Walker::go};
  Sync pace{*this, "pace", 1ms};
  Status on_configure() override {
    start_at(look);
    look.then(go);
    go.then(pace);
    pace.then(look);
    return ok();
  }
};

class TaskStatistics : public testing::Test {
 protected:
  void begin() {
    ASSERT_TRUE(component.configure());
    component.core().clock = &clock;
    auto first = std::make_unique<TaskUpdate>();
    first->bundle = component.bundle();
    first->grid = 1ms;
    task.begin(std::move(first), kT0);
  }
  /// Each job begins `late` after its release.
  void run(int count, Duration late = Duration{0}) {
    for (int i = 0; i < count; ++i) {
      clock.set(std::max(clock.now(), task.next_release() + late.count()));
      task.run_release();
    }
  }
  const rt::JobTimes& times() { return component.bundle()->measured->shown(); }
  Distribution state(const FsmState& one) { return times().states[one.index()].clean.look(); }
  TimeTotal preempted(const FsmState& one) { return times().states[one.index()].preempted.look(); }
  Duration sum(const FsmState& one) { return state(one).sum + preempted(one).sum; }
  std::uint64_t count(const FsmState& one) { return state(one).count + preempted(one).count; }

  static constexpr Instant kT0 = 1'000'000'000;
  ManualClock clock{kT0};
  Architecture architecture;
  Component<EmptyShell, Walker, Walking> component{architecture, "walker"};
  Task task{"walker", clock};
};

TEST_F(TaskStatistics, CountEveryStateWithItsOwnTime) {
  begin();

  run(10);

  EXPECT_EQ(count(component.fsm().look), 10u);
  EXPECT_EQ(sum(component.fsm().look), 10 * 100us);
  EXPECT_EQ(count(component.fsm().go), 10u);
  EXPECT_EQ(sum(component.fsm().go), 5 * 200us + 5 * 300us);
  EXPECT_EQ(count(component.fsm().pace), 0u) << "a wait is no work";
}

TEST_F(TaskStatistics, KnowLatenessExecutionAndResponseOfEveryJob) {
  begin();

  run(4, 50us);

  EXPECT_EQ(times().since, kT0 + 50'000);
  EXPECT_EQ(times().lateness.look().count, 4u);
  EXPECT_EQ(times().lateness.look().min, 50us);
  EXPECT_EQ(times().lateness.look().max, 50us);
  const Distribution clean = times().clean.look();
  const Distribution preempted = times().preempted.look();
  EXPECT_EQ(clean.count + preempted.count, 4u);
  EXPECT_EQ(clean.sum + preempted.sum, 2 * 300us + 2 * 400us);
  EXPECT_EQ(times().response.look().min, 350us);
  EXPECT_EQ(times().response.look().max, 450us);
  EXPECT_EQ(task.counters().elapsed_max, 400'000);
}

TEST_F(TaskStatistics, CountMissedOverrunsAndWhatIsOverBudget) {
  component.task().budget = 350us;
  component.task().deadline = 360us;
  begin();

  run(4);
  clock.advance(5ms);
  run(1);

  EXPECT_EQ(times().over_budget, 2u);
  EXPECT_EQ(times().overruns, 3u) << "the last one began too late";
  EXPECT_EQ(times().missed, task.counters().missed.load());
  EXPECT_GE(times().missed, 4u);
}

TEST_F(TaskStatistics, BeginAnewAfterAResetAndKeepTheCounters) {
  begin();
  run(3);

  component.bundle()->measured->reset();
  EXPECT_EQ(times().lateness.look().count, 0u);
  EXPECT_EQ(times().since, 0);
  run(2);

  EXPECT_EQ(count(component.fsm().look), 2u);
  EXPECT_EQ(times().lateness.look().count, 2u);
  EXPECT_EQ(times().since, kT0 + 3'000'000);
  EXPECT_EQ(task.counters().releases, 5u) << "probations and receipts count on";
}

/// Something surely comes between the one that sleeps, hardly ever between the other.
class Sleeper : public Core<EmptyShell> {
 public:
  void sleep() { std::this_thread::sleep_for(100us); }
  void wake() {}
};
struct Sleeping : Fsm<Sleeper> {
  Exec sleep{*this, "sleep", &Sleeper::sleep};
  Exec wake{*this, "wake", &Sleeper::wake};
  Sync pace{*this, "pace", 10ms};
  Status on_configure() override {
    start_at(sleep);
    sleep.then(wake);
    wake.then(pace);
    pace.then(sleep);
    return ok();
  }
};

TEST(Statistics, KeepApartWhatSomethingCameBetween) {
  if (!rt::preemption_is_reported())
    GTEST_SKIP() << "NOT TESTED: this kernel or libc does not detect it";
  Architecture architecture;
  Component<EmptyShell, Sleeper, Sleeping> component(architecture, "sleeper");
  Deployer deployer(architecture, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());

  EXPECT_TRUE(test::eventually([&] {
    deployer.run_for(100ms);
    return deployer.statistics("sleeper").states[1].execution.count > 0;
  })) << "a state is not blamed for the one before";

  const ComponentStatistics seen = deployer.statistics("sleeper");
  EXPECT_EQ(seen.states[0].execution.count, 0u);
  EXPECT_EQ(seen.states[0].preempted.count, seen.lateness.count);
  EXPECT_EQ(seen.execution.count, 0u) << "of a job every state counts";
  EXPECT_EQ(seen.preempted.count, seen.lateness.count);
}

/// Its job finds the lock held for longer than it may wait.
class Waiter : public Core<EmptyShell> {
 public:
  void update() {
    std::promise<void> held;
    std::promise<void> over;
    std::thread holder([&] {
      const ScopedLock scope(lock);
      held.set_value();
      over.get_future().wait();
    });
    held.get_future().wait();
    EXPECT_FALSE(lock.enter());
    over.set_value();
    holder.join();
  }
  ResourceLock lock;
};

TEST(Statistics, KnowHowLongJobsWaitedForLocks) {
  Architecture architecture;
  Component<EmptyShell, Waiter, PeriodicFsm<Waiter>> component(architecture, "waiter");
  Deployer deployer(architecture, {.simulated = true});
  ASSERT_TRUE(deployer.deploy());

  deployer.run_for(30ms);

  const TimeTotal waits = deployer.statistics("waiter").lock_waits;
  EXPECT_EQ(waits.count, 3u);
  EXPECT_GE(waits.longest, 10ms);
  EXPECT_GE(waits.sum, 30ms);
}

/// A simulated deployment of one ramp.
class DeployedStatistics : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(deployer.deploy()); }
  ComponentStatistics control() { return deployer.statistics("control"); }

  ramp::Architecture architecture;
  Deployer deployer{architecture, {.simulated = true}};
};

TEST_F(DeployedStatistics, AreAboutEachComponentAndItsStates) {
  deployer.run_for(100ms);

  const ComponentStatistics seen = control();

  EXPECT_EQ(seen.name, "control");
  EXPECT_EQ(seen.lateness.count, 10u);
  EXPECT_EQ(seen.response.count, 10u);
  ASSERT_EQ(seen.states.size(), 1u) << "waits are no work";
  EXPECT_EQ(seen.states[0].name, "update");
  EXPECT_EQ(seen.states[0].execution.count + seen.states[0].preempted.count, 10u);
  EXPECT_EQ(deployer.statistics().size(), deployer.status().size());
  EXPECT_EQ(deployer.statistics("nobody").name, "");
}

TEST_F(DeployedStatistics, BeginAnewWithAnotherCore) {
  deployer.run_for(100ms);

  ASSERT_TRUE(deployer.swap_core<ramp::Down>("control"));
  const std::uint64_t first = control().lateness.count;
  deployer.run_for(30ms);

  EXPECT_LE(first, 1u) << "the answer of a swap comes after its first job";
  EXPECT_EQ(control().lateness.count, first + 3);
  EXPECT_GT(control().since, 90ms);
}

TEST_F(DeployedStatistics, GoOnWhenAPropertyIsSet) {
  deployer.run_for(100ms);
  const std::uint64_t before = deployer.status("control").releases;

  ASSERT_TRUE(deployer.set("control.core.step", 2.0));
  ASSERT_TRUE(deployer.set("control.fsm.period", "5ms"));
  deployer.run_for(30ms);

  EXPECT_GT(deployer.status("control").releases, before);
  EXPECT_EQ(control().lateness.count, deployer.status("control").releases);
  EXPECT_EQ(control().states[0].execution.count + control().states[0].preempted.count,
            deployer.status("control").releases);
  EXPECT_EQ(control().since, Duration{0} + deployer.status("control").lateness_last)
      << "the first job, at T0";
}

TEST_F(DeployedStatistics, GoOnWhereTheyWereAfterARollback) {
  deployer.run_for(100ms);
  Change change{{ramp::to_core<ramp::Down>("ramp/down")}};
  change.probation = Probation{};
  ASSERT_TRUE(deployer.apply(change));
  deployer.run_for(30ms);
  ASSERT_TRUE(deployer.undo());
  deployer.run_for(20ms);
  Retired retired;
  static_cast<void>(deployer.tend(retired));
  const std::uint64_t jobs = control().lateness.count;

  deployer.run_for(30ms);

  EXPECT_GE(jobs, 10u) << "those before the change";
  EXPECT_EQ(control().lateness.count, jobs + 3);
}

TEST_F(DeployedStatistics, AreResetOfOneOrAllOnRequest) {
  deployer.run_for(50ms);

  EXPECT_EQ(deployer.reset_statistics("contrl").error().code, Errc::unknown_name);
  EXPECT_EQ(control().lateness.count, 5u) << "a refusal changes nothing";
  ASSERT_TRUE(deployer.reset_statistics("control"));
  EXPECT_EQ(control().lateness.count, 0u);
  deployer.run_for(20ms);
  EXPECT_EQ(control().lateness.count, 2u);
  ASSERT_TRUE(deployer.reset_statistics());
  EXPECT_EQ(control().states[0].execution.count, 0u);
}

TEST_F(DeployedStatistics, BeginAnewWithAnotherDeployment) {
  deployer.run_for(50ms);
  deployer.shutdown();

  Deployer other(architecture, {.simulated = true});
  ASSERT_TRUE(other.deploy());
  other.run_for(20ms);

  EXPECT_EQ(other.statistics("control").lateness.count, 2u);
}

}  // namespace
}  // namespace mauve::exec
