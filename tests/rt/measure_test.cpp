// SPDX-License-Identifier: LGPL-3.0-or-later
/// The times that the runtime measures for admission: those of a job, those for which it holds a
/// resource, and those that the machine takes for itself.
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "rt/machine/machine_costs.h"
#include "rt/thread/preemption.h"
#include "rt/thread/thread.h"
#include "support/eventually.h"

#include <mauve/detail/resource_lock.h>
#include <mauve/host/clock.h>

namespace mauve {
namespace {

constexpr Duration kHeld = 300us;

void busy_for(Duration time) {
  const MonotonicClock clock;
  const Instant end = clock.now() + time.count();
  while (clock.now() < end) {
  }
}

TEST(Preemption, IsDetectedWhereTheKernelKnowsRestartableSequences) {
  if (!rt::preemption_is_reported())
    GTEST_SKIP() << "NOT TESTED: this kernel or libc does not detect it";
  rt::watch_for_preemption();
  std::this_thread::sleep_for(100us);
  EXPECT_TRUE(rt::preempted()) << "a thread that sleeps is preempted";

  EXPECT_TRUE(test::eventually([] {
    rt::watch_for_preemption();
    busy_for(10us);
    return !rt::preempted();
  })) << "ten microseconds in a row";

  rt::end_preemption_watch();
  EXPECT_TRUE(rt::preempted()) << "nobody watched";
}

TEST(ResourceLock, KnowsHowLongAnUninterruptedJobHeldIt) {
  if (!rt::preemption_is_reported())
    GTEST_SKIP() << "NOT TESTED: this kernel or libc does not detect it";
  ResourceLock lock;
  ResourceLock shortly;
  shortly.hold_shortly();
  const MonotonicClock clock;
  const Instant begin = clock.now();

  EXPECT_TRUE(test::eventually([&] {
    rt::watch_for_preemption();
    {
      const ScopedLock one(lock);
      const ScopedLock other(shortly);
      busy_for(kHeld);
    }
    return lock.longest_held() > Duration{0};
  }));
  rt::end_preemption_watch();

  EXPECT_GE(lock.longest_held(), kHeld);
  EXPECT_LE(lock.longest_held(), Duration{clock.now() - begin});
  EXPECT_EQ(shortly.longest_held(), Duration{0}) << "the clock would take longer";
}

TEST(ResourceLock, CountsWhatWasHeldLongerThanDeclared) {
  if (!rt::preemption_is_reported())
    GTEST_SKIP() << "NOT TESTED: this kernel or libc does not detect it";
  ResourceLock longer;
  ResourceLock shorter;
  longer.set_budget(kHeld / 2);
  shorter.set_budget(1h);

  EXPECT_TRUE(test::eventually([&] {
    rt::watch_for_preemption();
    {
      const ScopedLock one(longer);
      const ScopedLock other(shorter);
      busy_for(kHeld);
    }
    return longer.longest_held() > Duration{0} && shorter.longest_held() > Duration{0};
  }));
  rt::end_preemption_watch();

  EXPECT_GE(longer.over_budget(), 1U);
  EXPECT_EQ(shorter.over_budget(), 0U);
  longer.forget_times();
  EXPECT_EQ(longer.budget(), kHeld / 2) << "another core is held as long, by declaration";
}

TEST(ResourceLock, DoesNotMeasureOutsideJobs) {
  ResourceLock lock;
  {
    const ScopedLock entry(lock);
    busy_for(kHeld);
  }
  EXPECT_EQ(lock.longest_held(), Duration{0});
}

TEST(MachineCosts, AreMeasuredOnEachCpuAtRealTimePriority) {
  if (!rt::may_use_fifo(50)) {
    EXPECT_FALSE(rt::measure_machine(rt::usable_cpus(), 50));
    GTEST_SKIP() << "NOT TESTED: no SCHED_FIFO here";
  }

  const auto costs = rt::measure_machine(rt::usable_cpus(), 50);

  ASSERT_TRUE(costs);
  EXPECT_GT(costs->wake, Duration{0});
  EXPECT_NE(*costs, MachineCosts{}) << "measured, not the defaults";
  EXPECT_GT(costs->activation, Duration{0});
  EXPECT_GT(costs->interrupt, Duration{0});
  EXPECT_LT(costs->kernel, 2 * MachineCosts::window) << "with a margin of two";
}

}  // namespace
}  // namespace mauve
