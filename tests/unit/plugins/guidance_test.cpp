// SPDX-License-Identifier: LGPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <functional>

#include "../../../plugins/guidance/avoidance.h"
#include "../../../plugins/guidance/field.h"
#include "../../../plugins/guidance/gap.h"
#include "../../../plugins/world/world.h"

namespace {

using guidance::AvoidanceParameters;
using guidance::FieldParameters;
using guidance::Guidance;
using guidance::Obstacles;
using rover::LaserScan;
using rover::Point2D;
using rover::Pose2D;
using rover::Velocity;

constexpr double kStep = 0.01;      // s, the pace of the control loop
constexpr double kArrived = 0.15;   // m
constexpr double kTouching = 0.35;  // m from the robot's centre to a surface
constexpr double kLimit = 120.0;    // s, then a run counts as failed

using Law = std::function<Velocity(const Pose2D&, const Obstacles&, Guidance&)>;

struct Drive {
  bool reached = false;
  double seconds = 0.0;
  double length = 0.0;
  double clearance = 1e9;
  bool slewed = true;  // every command within the limits of its predecessor
};

/// Drives one robot from the origin: scans at 40 Hz, control at 100 Hz, as in the rover.
Drive drive(const Law& law, const world::Map& map, const Point2D& goal, std::uint64_t seed,
            const world::Disturbance& disturbance) {
  world::Robot robot(seed);
  world::Random random(seed);
  Guidance state;
  state.goal = goal;
  state.dwell = 10.0;
  LaserScan scan;
  Obstacles obstacles;
  Drive run;
  const guidance::SlewLimits limits;
  for (int step = 0; run.seconds < kLimit; ++step, run.seconds += kStep) {
    const Pose2D pose = robot.pose();
    if (rover::distance(pose, goal) < kArrived) {
      run.reached = true;
      break;
    }
    if (step * 2 / 5 != (step - 1) * 2 / 5 || step == 0) {
      world::cast(map, pose, {}, random, scan);
    }
    guidance::nearest_points(scan, pose, 3.0, obstacles);
    const Velocity command =
        guidance::slewed(state.command, law(pose, obstacles, state), limits, kStep);
    run.slewed = run.slewed &&
                 std::abs(command.linear - state.command.linear) <= limits.slow_down * kStep + 1e-9;
    state.command = command;
    robot.drive(command, disturbance, kStep);
    run.length += std::abs(command.linear) * kStep;
    run.clearance = std::min(run.clearance, map.clearance({robot.pose().x, robot.pose().y}));
  }
  return run;
}

Law field(const FieldParameters& parameters) {
  return [p = guidance::repaired(parameters)](const Pose2D& pose, const Obstacles& obstacles,
                                              Guidance& state) {
    return guidance::follow_field(p, pose, obstacles, state);
  };
}

Law finite_time(const AvoidanceParameters& parameters = {}) {
  return [parameters](const Pose2D& pose, const Obstacles& obstacles, Guidance& state) {
    return guidance::avoid(parameters, pose, obstacles, kStep, state);
  };
}

struct Summary {
  int reached = 0;
  double least_clearance = 1e9;
  double mean_seconds = 0.0;
  bool slewed = true;
};

Summary drive_worlds(const Law& law, int worlds, std::size_t discs, double gap, double length) {
  Summary sum;
  const Point2D goal{length, 0.0};
  for (int i = 0; i < worlds; ++i) {
    const auto seed = static_cast<std::uint64_t>(i + 1);
    const std::size_t count = discs > 6 ? discs : seed % (discs + 1);
    const world::Map map = world::random_map(seed, count, gap, {}, goal);
    const Drive run = drive(law, map, goal, seed, {0.1, 0.5});
    sum.reached += run.reached ? 1 : 0;
    sum.least_clearance = std::min(sum.least_clearance, run.clearance);
    sum.mean_seconds += run.seconds / worlds;
    sum.slewed = sum.slewed && run.slewed;
  }
  testing::Test::RecordProperty("mean_seconds", std::to_string(sum.mean_seconds));
  return sum;
}

void expect_all_reached(const Summary& sum, int worlds) {
  EXPECT_EQ(sum.reached, worlds);
  EXPECT_GT(sum.least_clearance, kTouching);
  EXPECT_TRUE(sum.slewed);
}

/// The defaults of the paper's listing: an empty blending band, and a barrier of no width.
FieldParameters published() {
  FieldParameters p;
  p.nu = 0.2;
  p.psi = 0.2;
  p.obstacle_distance = 0.8;
  p.safety_distance = 0.8;
  return p;
}

world::Map disc_on_the_line() {
  world::Map map;
  map.add({{5.0, 0.0}, 0.5});
  return map;
}

TEST(HeadingLaw, TurnsAgainstTheErrorWithinItsLimit) {
  const guidance::HeadingLaw law;

  EXPECT_LT(guidance::turn_rate(0.5, law), 0.0);
  EXPECT_GT(guidance::turn_rate(-0.5, law), 0.0);
  EXPECT_DOUBLE_EQ(guidance::turn_rate(3.0, law), -law.turn_max);
  EXPECT_DOUBLE_EQ(guidance::turn_rate(0.0, law), 0.0);
}

TEST(HeadingLaw, ReachesZeroErrorInTheTimeTheTheoryGives) {
  guidance::HeadingLaw law;
  law.turn_max = 100.0;
  const double start = 1.0;
  double error = start;
  double seconds = 0.0;

  while (std::abs(error) > law.layer && seconds < 10.0) {
    error += (guidance::turn_rate(error, law) + 0.25) * 0.001;  // a disturbance below the margin
    seconds += 0.001;
  }

  EXPECT_LE(seconds, 2.0 * std::sqrt(start) / law.gain);
}

TEST(Slew, LimitsSpeedAndTurnOfOneStep) {
  const Velocity next = guidance::slewed({0.0, 0.0}, {1.0, -1.5}, {1.5, 3.0, 20.0}, 0.01);

  EXPECT_DOUBLE_EQ(next.linear, 0.015);
  EXPECT_DOUBLE_EQ(next.angular, -0.2);
}

TEST(PotentialField, BlendsFromOneToZeroWithFlatEnds) {
  EXPECT_DOUBLE_EQ(guidance::blend(0.2, 0.2, 1.0), 1.0);
  EXPECT_NEAR(guidance::blend(0.2 + 1e-9, 0.2, 1.0), 1.0, 1e-6);
  EXPECT_NEAR(guidance::blend(1.0 - 1e-9, 0.2, 1.0), 0.0, 1e-6);
  EXPECT_DOUBLE_EQ(guidance::blend(1.0, 0.2, 1.0), 0.0);
  EXPECT_NEAR(guidance::blend(0.2 + 1e-4, 0.2, 1.0), 1.0, 1e-6);
}

TEST(PotentialField, SurvivesThePublishedDefaultsWhereNuEqualsPsi) {
  const FieldParameters p = guidance::repaired(published());

  EXPECT_DOUBLE_EQ(guidance::attraction(0.1, p), 0.5);
  EXPECT_DOUBLE_EQ(guidance::attraction(0.2, p), 1.0);
  EXPECT_DOUBLE_EQ(guidance::attraction(0.3, p), 1.0);
  EXPECT_DOUBLE_EQ(p.obstacle_distance, 1.0);
  EXPECT_TRUE(std::isfinite(guidance::repulsion(0.8, p)));
}

TEST(PotentialField, PullNeverExceedsOneAndGrowsWithDistance) {
  const FieldParameters p;
  double last = -1.0;

  for (double s = 0.0; s < 2.0; s += 0.01) {
    const double now = guidance::attraction(s, p);
    EXPECT_GE(now, last - 1e-12);
    EXPECT_LE(now, 1.0 + 1e-12);
    last = now;
  }
}

TEST(PotentialField, PushEqualsThePullAtTheSafetyDistance) {
  const FieldParameters p;

  EXPECT_NEAR(guidance::repulsion(p.safety_distance, p), 1.0, 1e-12);
  EXPECT_DOUBLE_EQ(guidance::repulsion(p.obstacle_distance, p), 0.0);
  EXPECT_DOUBLE_EQ(guidance::repulsion(0.0, p), 0.0);
}

TEST(PotentialField, StandsBeforeADiscOnTheLineWithoutTheEscapeInput) {
  FieldParameters p;
  p.escape = 0.0;
  const Drive run = drive(field(p), disc_on_the_line(), {10.0, 0.0}, 1, {});

  EXPECT_FALSE(run.reached);
  EXPECT_NEAR(run.clearance, p.safety_distance, 0.02);
}

TEST(PotentialField, PassesADiscOnTheLineWithTheEscapeInput) {
  const Drive run = drive(field({}), disc_on_the_line(), {10.0, 0.0}, 1, {});

  EXPECT_TRUE(run.reached);
  EXPECT_LT(run.seconds, 25.0);
}

TEST(PotentialField, ReachesTheGoalInThreeHundredOpenWorldsWithoutTouching) {
  expect_all_reached(drive_worlds(field({}), 300, 6, 2.1, 10.0), 300);
}

TEST(PotentialField, ReachesTheGoalInOpenWorldsWithThePublishedDefaultsRepaired) {
  expect_all_reached(drive_worlds(field(published()), 100, 6, 2.1, 10.0), 100);
}

TEST(PotentialField, NeverTouchesInDenseWorlds) {
  const Summary sum = drive_worlds(field({}), 50, 14, 1.6, 7.0);

  EXPECT_GT(sum.least_clearance, kTouching);
}

TEST(FiniteTime, ReachesTheGoalInThreeHundredOpenWorldsWithoutTouching) {
  expect_all_reached(drive_worlds(finite_time(), 300, 6, 2.1, 10.0), 300);
}

TEST(FiniteTime, ReachesTheGoalInDenseWorldsWithoutTouching) {
  expect_all_reached(drive_worlds(finite_time(), 50, 14, 1.6, 7.0), 50);
}

TEST(WidestGap, ReachesTheGoalInOpenWorldsWithoutTouching) {
  world::Random random(1);
  LaserScan scan;
  const world::Map* map = nullptr;
  const Law law = [&](const Pose2D& pose, const Obstacles&, Guidance& state) {
    world::cast(*map, pose, {}, random, scan);
    return guidance::follow_gap({}, pose, scan, state);
  };
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const world::Map discs = world::random_map(seed, seed % 7, 2.1, {}, {10.0, 0.0});
    map = &discs;
    const Drive run = drive(law, discs, {10.0, 0.0}, seed, {0.1, 0.5});

    EXPECT_TRUE(run.reached) << "world " << seed;
    EXPECT_GT(run.clearance, kTouching) << "world " << seed;
  }
}

TEST(FiniteTime, IsQuickerThanTheFieldInOpenWorlds) {
  const Summary quick = drive_worlds(finite_time(), 30, 6, 2.1, 10.0);
  const Summary field_like = drive_worlds(field({}), 30, 6, 2.1, 10.0);

  EXPECT_LT(quick.mean_seconds, field_like.mean_seconds);
}

TEST(FiniteTime, WaitsTheDwellTimeBeforeItDecidesAgain) {
  AvoidanceParameters p;
  Guidance state;
  state.goal = {5.0, 0.0};
  state.dwell = 10.0;
  Obstacles near;
  near.size = 1;
  near.found[0] = {{1.0, 0.0}, 1.0, 0.0};

  (void)guidance::avoid(p, {}, near, kStep, state);
  ASSERT_EQ(state.avoiding, 1);
  (void)guidance::avoid(p, {}, {}, kStep, state);
  EXPECT_EQ(state.avoiding, 1);
  for (int i = 0; i < 60; ++i) (void)guidance::avoid(p, {}, {}, kStep, state);

  EXPECT_EQ(state.avoiding, 0);
}

TEST(Swap, HalfWayKeepsGoalAndCommandAndStillArrives) {
  const Law first = field({});
  const Law second = finite_time();
  const Law swapped = [&](const Pose2D& pose, const Obstacles& obstacles, Guidance& state) {
    return pose.x < 4.5 ? first(pose, obstacles, state) : second(pose, obstacles, state);
  };
  const Drive run = drive(swapped, disc_on_the_line(), {10.0, 0.0}, 1, {0.1, 0.5});

  EXPECT_TRUE(run.reached);
  EXPECT_TRUE(run.slewed);
  EXPECT_GT(run.clearance, kTouching);
}

TEST(Obstacles, OnePointForEachThingInSight) {
  world::Map map;
  map.add({{3.0, 1.5}, 0.5});
  map.add({{3.0, -1.5}, 0.5});
  world::Random random(1);
  LaserScan scan;
  world::cast(map, {}, {}, random, scan);
  Obstacles obstacles;

  guidance::nearest_points(scan, {}, 5.0, obstacles);

  ASSERT_EQ(obstacles.size, 2U);
  EXPECT_NEAR(obstacles.found[0].range, std::hypot(3.0, 1.5) - 0.5, 0.01);
  EXPECT_NEAR(obstacles.found[0].bearing, std::atan2(-1.5, 3.0), 0.01);
}

TEST(Obstacles, IgnoresErrorCodesAndAnEmptyScan) {
  LaserScan scan;
  scan.range_min = 0.02F;
  scan.range_max = 4.0F;
  Obstacles obstacles;

  guidance::nearest_points(scan, {}, 5.0, obstacles);
  EXPECT_EQ(obstacles.size, 0U);
  scan.ranges.resize(3);
  scan.ranges[1] = 0.01F;
  scan.ranges[2] = 4.0F;
  guidance::nearest_points(scan, {}, 5.0, obstacles);

  EXPECT_EQ(obstacles.size, 0U);
}

}  // namespace
