// SPDX-License-Identifier: LGPL-3.0-or-later
/// The core without threads: the test sets the values of its ports and calls its methods.
#include <gtest/gtest.h>
#include <mauve/test_kit.h>

#include "homing.h"

namespace {

using namespace guidance;

/// A scanner that looks straight ahead with one beam.
LaserScan scan_of(float range) {
  LaserScan scan;
  scan.range_max = 5.0F;
  scan.ranges.push_back(range);
  return scan;
}

struct StraightTest : testing::Test {
  StraightTest() {
    EXPECT_TRUE(bench.configure());
    bench.give(bench.shell().pose, Pose2D{0.0, 0.0, 0.0});
    bench.give(bench.shell().goal, Point2D{5.0, 0.0});
  }
  /// The command after so many jobs, one each 10 ms.
  Velocity command_after(int jobs, const LaserScan& scan) {
    bench.give(bench.shell().scan, scan);
    for (int i = 0; i < jobs; ++i) {
      bench.advance(10ms);
      bench.core().advance();
    }
    return bench.written(bench.shell().command).value();
  }
  mauve::CoreBench<ControlShell, homing::Straight> bench;
};

TEST_F(StraightTest, DrivesStraightToAGoalAhead) {
  const Velocity command = command_after(100, scan_of(5.0F));
  EXPECT_NEAR(command.linear, 0.3, 1e-6);
  EXPECT_NEAR(command.angular, 0.0, 1e-6);
}

TEST_F(StraightTest, TurnsAsideInFrontOfAnObstacle) {
  const Velocity command = command_after(100, scan_of(0.5F));
  EXPECT_GT(std::abs(command.angular), 0.5);
  EXPECT_NEAR(command.linear, 0.0, 1e-6);
}

TEST_F(StraightTest, UsesNeitherHeapNorKernelInAJob) {
  command_after(1, scan_of(5.0F));
  const mauve::JobCost cost = bench.cost([&] { bench.core().advance(); });
  EXPECT_EQ(cost.heap_calls.value_or(0), 0U);
  EXPECT_EQ(cost.system_calls.value_or(0), 0U);
}

TEST(Straight, RefusesASpeedOutOfRange) {
  mauve::CoreBench<ControlShell, homing::Straight> bench;
  EXPECT_FALSE(bench.core().find_property("speed")->set(mauve::Value(1.5)));
}

}  // namespace
