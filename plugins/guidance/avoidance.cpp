// SPDX-License-Identifier: LGPL-3.0-or-later
#include "avoidance.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace guidance {
namespace {

constexpr double kQuarter = std::numbers::pi / 2.0;
constexpr double kSteepest = std::numbers::pi / 3.0;  // away from an obstacle that is too near
constexpr double kBeside = std::numbers::pi / 6.0;    // so far on the other side is still ahead
constexpr int kMostTurns = 8;                         // from one obstacle on to the next

struct View {
  double goal_range;
  double goal_bearing;
  const Obstacles& obstacles;
  const Obstacle* nearest = nullptr;     // may be null, as the next
  const Obstacle* in_the_way = nullptr;  // nearest on the straight way to the goal
};

/// The nearest one that a robot would pass nearer than `half_width` on its way to the goal.
const Obstacle* in_the_way(const View& view, double half_width) {
  const Obstacle* nearest = nullptr;
  for (const Obstacle& obstacle : view.obstacles) {
    const double angle = rover::wrap(obstacle.bearing - view.goal_bearing);
    const bool ahead = std::abs(angle) < kQuarter && obstacle.range < view.goal_range;
    if (!ahead || obstacle.range * std::abs(std::sin(angle)) >= half_width) continue;
    if (nearest == nullptr || obstacle.range < nearest->range) nearest = &obstacle;
  }
  return nearest;
}

bool must_avoid(const AvoidanceParameters& p, const View& view) {
  return view.in_the_way != nullptr && view.in_the_way->range < p.obstacle_distance;
}

bool may_go(const AvoidanceParameters& p, const View& view, const Guidance& state) {
  const auto far = [&](const Obstacle* obstacle) {
    return obstacle == nullptr || obstacle->range > p.hysteresis * p.obstacle_distance;
  };
  return far(view.nearest) || (far(view.in_the_way) && view.goal_range < state.hit_range);
}

/// Half of the directions that lead nearer than `distance` past it, seen from here.
double half_arc(const Obstacle& obstacle, double distance) {
  if (obstacle.range >= distance) return std::asin(distance / obstacle.range);
  return kQuarter - std::max(std::atan2(obstacle.range - distance, 0.5 * distance), -kSteepest);
}

/// Along the obstacle, turned towards it when too far and away from it when too near.
double tangent(const Obstacle& obstacle, double distance, int side) {
  const double tilt =
      std::clamp(std::atan2(obstacle.range - distance, 0.5 * distance), -kSteepest, kQuarter / 2.0);
  return obstacle.bearing + side * (kQuarter - tilt);
}

/// The obstacle that is gone round: the nearest that is not on the other side of the robot, else
/// the one in the way. Looking at one side only, the robot does not waver between two.
const Obstacle* gone_round(const View& view, double heading, int side) {
  const Obstacle* nearest = nullptr;
  for (const Obstacle& obstacle : view.obstacles) {
    if (side * rover::wrap(obstacle.bearing - heading) > kBeside) continue;
    if (nearest == nullptr || obstacle.range < nearest->range) nearest = &obstacle;
  }
  return nearest == nullptr ? view.in_the_way : nearest;
}

/// The first direction beyond the tangent that passes everything else up to `limit`.
double past_all(const Obstacle& round, const Obstacles& obstacles, double limit, double distance,
                int side) {
  constexpr double kTouching = 1e-9;  // rad
  double direction = tangent(round, distance, side);
  for (int turn = 0; turn < kMostTurns; ++turn) {
    const double before = direction;
    for (const Obstacle& other : obstacles) {
      if (&other == &round || other.range > limit) continue;
      const double half = half_arc(other, distance);
      if (std::abs(rover::wrap(direction - other.bearing)) >= half - kTouching) continue;
      direction = other.bearing + side * half;
    }
    if (direction == before) break;
  }
  return direction;
}

/// Round everything at d_safe; nearer where that would lead away from the goal and nearer does not.
double way_round(const AvoidanceParameters& p, const View& view, double heading, int side) {
  const Obstacle* const obstacle = gone_round(view, heading, side);
  if (obstacle == nullptr) return view.goal_bearing;
  const double limit = p.hysteresis * p.obstacle_distance;
  const auto at = [&](double distance) {
    return past_all(*obstacle, view.obstacles, limit, distance, side);
  };
  const auto leads_on = [&](double direction) {
    return std::abs(rover::wrap(direction - view.goal_bearing)) <= kQuarter;
  };
  const double wide = at(p.safety_distance);
  if (leads_on(wide)) return wide;
  const double close = at(p.squeeze * p.safety_distance);
  return leads_on(close) ? close : wide;
}

/// Decides between GO and AVOID, at most once in a dwell time.
void supervise(const AvoidanceParameters& p, const View& view, double dt, Guidance& state) {
  state.dwell += dt;
  if (state.dwell < std::chrono::duration<double>(p.dwell).count()) return;
  if (state.avoiding == 0 && must_avoid(p, view)) {
    state.avoiding = 1;
    state.side = rover::wrap(view.goal_bearing - view.in_the_way->bearing) < 0.0 ? -1 : 1;
    state.hit_range = view.goal_range;
    state.dwell = 0.0;
  } else if (state.avoiding == 1 && may_go(p, view, state)) {
    state.avoiding = 0;
    state.side = 0;
    state.dwell = 0.0;
  } else if (state.avoiding == 1 && view.goal_range > state.hit_range + p.obstacle_distance) {
    // The wrong way round: it leads farther and farther away.
    state.side = -state.side;
    state.hit_range = view.goal_range;
    state.dwell = 0.0;
  }
}

}  // namespace

Velocity avoid(const AvoidanceParameters& p, const Pose2D& pose, const Obstacles& obstacles,
               double dt, Guidance& state) {
  View view{distance(pose, state.goal), bearing(pose, state.goal), obstacles, obstacles.nearest()};
  const double half_width = p.safety_distance * (state.avoiding == 1 ? p.hysteresis : 1.0);
  view.in_the_way = in_the_way(view, half_width);
  supervise(p, view, dt, state);
  const bool around = state.avoiding == 1 && view.nearest != nullptr;
  // A core that hands over mid-avoidance may not have chosen a side.
  if (around && state.side == 0) state.side = 1;
  const double wanted = around ? way_round(p, view, pose.heading, state.side) : view.goal_bearing;
  const double error = rover::wrap(pose.heading - wanted);
  const double speed = p.speed * std::min(1.0, std::sqrt(view.goal_range)) *
                       std::max(0.0, std::cos(error)) * (around ? p.avoid_speed : 1.0);
  return {speed, turn_rate(error, p.heading)};
}

}  // namespace guidance
