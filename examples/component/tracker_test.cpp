// SPDX-License-Identifier: LGPL-3.0-or-later
/// The core alone, and the whole component with its state machine on a simulated clock.
#include <gtest/gtest.h>
#include <mauve/test_kit.h>

#include "tracker.h"

namespace {

using tracker::Filter;
using tracker::Motion;

TEST(Filter, FindsTheSpeedOfASteadyMotion) {
  mauve::CoreBench<tracker::Shell, Filter> bench;
  ASSERT_TRUE(bench.configure());
  for (int i = 1; i <= 500; ++i) {
    bench.advance(10ms);
    bench.give(bench.shell().measured, 0.02 * i);  // 2 m/s, measured each 10 ms
    bench.core().update();
  }
  const Motion motion = bench.written(bench.shell().motion).value();
  EXPECT_NEAR(motion.position, 10.0, 1e-6);
  EXPECT_NEAR(motion.speed, 2.0, 1e-6);
}

TEST(Filter, PredictsWhileNothingIsMeasured) {
  mauve::CoreBench<tracker::Shell, Filter> bench;
  ASSERT_TRUE(bench.configure());
  *bench.core().state = {1.0, 3.0};
  for (int i = 0; i < 10; ++i) {
    bench.advance(10ms);
    bench.core().update();
  }
  EXPECT_NEAR(bench.written(bench.shell().motion)->position, 1.3, 1e-9);
  EXPECT_EQ(bench.core().without_data, 10);
}

TEST(Component, RunsEachPeriodWithoutTheHeap) {
  mauve::ComponentBench<tracker::Shell, Filter, mauve::PeriodicFsm<Filter>> bench;
  ASSERT_TRUE(bench.deploy());
  bench.run_for(1s);
  EXPECT_EQ(bench.status().releases, 100U);  // at 0 ms, 10 ms, ... 990 ms
  EXPECT_EQ(bench.cost().heap_calls.value_or(0), 0U);
}

}  // namespace
