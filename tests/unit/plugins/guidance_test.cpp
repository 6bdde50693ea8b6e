// SPDX-License-Identifier: LGPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "../../../plugins/guidance/avoidance.h"
#include "../../../plugins/guidance/field.h"
#include "../../../plugins/guidance/gap.h"
#include "../../../plugins/world/world.h"
#include "support/drive.h"

namespace {

using guidance::AvoidanceParameters;
using guidance::FieldParameters;
using guidance::Guidance;
using guidance::Obstacles;
using rover::LaserScan;
using rover::Pose2D;
using rover::Velocity;
using support::drive::drive_worlds;
using support::drive::driven_by;
using support::drive::field;
using support::drive::finite_time;
using support::drive::kStep;
using support::drive::Law;
using support::drive::Outcome;
using support::drive::Summary;

Outcome drive_to(const Law& law, const world::Map& map, const world::Disturbance& disturbance) {
  support::drive::Conditions conditions;
  conditions.disturbance = disturbance;
  return support::drive::drive(driven_by(law), {map, nullptr}, {10.0, 0.0}, 1, conditions);
}

void expect_all_reached(const Summary& sum, int worlds) {
  EXPECT_EQ(sum.reached, worlds);
  EXPECT_EQ(sum.touched, 0) << "least clearance " << sum.least_clearance();
  EXPECT_LE(sum.jump, 1.0 + 1e-9) << "of what the slew limits allow";
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
  const Outcome run = drive_to(field(p), disc_on_the_line(), {});

  EXPECT_FALSE(run.reached);
  EXPECT_NEAR(run.clearance, p.safety_distance, 0.02);
}

TEST(PotentialField, PassesADiscOnTheLineWithTheEscapeInput) {
  const Outcome run = drive_to(field(), disc_on_the_line(), {});

  EXPECT_TRUE(run.reached);
  EXPECT_LT(run.seconds, 25.0);
}

TEST(PotentialField, ReachesTheGoalInRandomWorldsWithoutTouching) {
  expect_all_reached(drive_worlds(driven_by(field()), support::drive::kOpen, 100), 100);
  expect_all_reached(drive_worlds(driven_by(field()), support::drive::kDense, 60), 60);
  expect_all_reached(drive_worlds(driven_by(field()), support::drive::kDenser, 60), 60);
}

TEST(PotentialField, ReachesTheGoalInOpenWorldsWithThePublishedDefaultsRepaired) {
  expect_all_reached(drive_worlds(driven_by(field(published())), support::drive::kOpen, 50), 50);
}

TEST(FiniteTime, ReachesTheGoalInRandomWorldsWithoutTouching) {
  expect_all_reached(drive_worlds(driven_by(finite_time()), support::drive::kOpen, 100), 100);
  expect_all_reached(drive_worlds(driven_by(finite_time()), support::drive::kDense, 60), 60);
  expect_all_reached(drive_worlds(driven_by(finite_time()), support::drive::kDenser, 60), 60);
}

TEST(FiniteTime, IsQuickerThanTheFieldInOpenWorlds) {
  const Summary quick = drive_worlds(driven_by(finite_time()), support::drive::kOpen, 30);
  const Summary other = drive_worlds(driven_by(field()), support::drive::kOpen, 30);

  EXPECT_LT(support::drive::mean(quick.seconds), support::drive::mean(other.seconds));
}

TEST(WidestGap, ReachesTheGoalInOpenWorldsWithoutTouching) {
  const Law law = support::drive::widest_gap();

  expect_all_reached(drive_worlds(driven_by(law), support::drive::kOpen, 15), 15);
}

/// At these ranges and bearings, seen from the origin.
Obstacles at(std::initializer_list<std::pair<double, double>> places) {
  Obstacles obstacles;
  for (const auto& [range, bearing] : places) {
    obstacles.found[obstacles.size++] = {
        {range * std::cos(bearing), range * std::sin(bearing)}, range, bearing};
  }
  return obstacles;
}

Guidance bound_for(double x) {
  Guidance state;
  state.goal = {x, 0.0};
  state.dwell = 10.0;
  return state;
}

TEST(FiniteTime, DoesNotAvoidWhatStandsBesideTheWay) {
  Guidance state = bound_for(5.0);

  const Velocity command =
      guidance::avoid({}, {}, at({{0.9, 1.0}, {0.8, -1.2}, {0.5, 2.0}}), kStep, state);

  EXPECT_EQ(state.avoiding, 0);
  EXPECT_DOUBLE_EQ(command.linear, AvoidanceParameters{}.speed);
  EXPECT_DOUBLE_EQ(command.angular, 0.0);
}

TEST(FiniteTime, GoesOnBetweenTwoThatAreNearerThanItsSafetyDistance) {
  for (const double half : {0.65, 0.55}) {
    for (const double x : {-0.4, -0.2, 0.0, 0.2}) {
      Guidance state = bound_for(5.0);
      const double range = std::hypot(x, half);
      const double bearing = std::atan2(half, -x);
      const Obstacles posts = at({{range, bearing}, {range, -bearing}});

      const Velocity command = guidance::avoid({}, {}, posts, kStep, state);

      EXPECT_GT(command.linear, 0.3) << x << ", " << half;
    }
  }
}

TEST(FiniteTime, TurnsBackWhenItsWayRoundLeadsAway) {
  Guidance state = bound_for(5.0);
  (void)guidance::avoid({}, {}, at({{1.0, 0.1}}), kStep, state);
  ASSERT_EQ(state.avoiding, 1);
  const int side = state.side;
  state.dwell = 10.0;

  (void)guidance::avoid({}, {-1.1, 0.0, 0.0}, at({{1.0, 0.1}}), kStep, state);
  EXPECT_EQ(state.side, side) << "by less than obstacle_distance";
  (void)guidance::avoid({}, {-1.3, 0.0, 0.0}, at({{1.0, 0.1}}), kStep, state);

  EXPECT_EQ(state.avoiding, 1);
  EXPECT_EQ(state.side, -side);
  EXPECT_DOUBLE_EQ(state.hit_range, 6.3);
}

TEST(Aim, ChoosesTheWayRoundAnewForAnotherGoalOnly) {
  Guidance state = bound_for(5.0);
  state.avoiding = state.side = 1;
  state.dwell = 0.0;

  guidance::aim_at({5.1, 0.0}, state);
  EXPECT_EQ(state.avoiding, 1);
  EXPECT_DOUBLE_EQ(state.goal.x, 5.1);
  guidance::aim_at({5.1, 1.0}, state);

  EXPECT_EQ(state.avoiding, 0);
  EXPECT_EQ(state.side, 0);
  EXPECT_GT(state.dwell, std::chrono::duration<double>(AvoidanceParameters{}.dwell).count());
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
  const Law first = field();
  const Law second = finite_time();
  const Law swapped = [&](const Pose2D& pose, const LaserScan& scan, const Obstacles& obstacles,
                          Guidance& state) {
    return pose.x < 4.5 ? first(pose, scan, obstacles, state)
                        : second(pose, scan, obstacles, state);
  };
  const Outcome run = drive_to(swapped, disc_on_the_line(), {0.1, 0.5});

  EXPECT_TRUE(run.reached);
  EXPECT_LE(run.jump, 1.0 + 1e-9);
  EXPECT_GT(run.clearance, support::drive::kTouching);
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
