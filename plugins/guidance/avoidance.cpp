// SPDX-License-Identifier: LGPL-3.0-or-later
#include "avoidance.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace guidance {
namespace {

constexpr double kQuarter = std::numbers::pi / 2.0;

struct View {
  double goal_range;
  double goal_bearing;
  const Obstacle* obstacle;  // nearest one, may be null
};

bool towards_goal(const View& view) {
  return std::abs(rover::wrap(view.obstacle->bearing - view.goal_bearing)) < kQuarter;
}

bool must_avoid(const AvoidanceParameters& p, const View& view) {
  return view.obstacle != nullptr && view.obstacle->range < p.obstacle_distance &&
         towards_goal(view) && view.obstacle->range < view.goal_range;
}

bool may_go(const AvoidanceParameters& p, const View& view, const Guidance& state) {
  if (view.obstacle == nullptr) return true;
  if (view.obstacle->range > p.hysteresis * p.obstacle_distance) return true;
  return !towards_goal(view) && view.goal_range < state.hit_range;
}

/// Decides between GO and AVOID, at most once in a dwell time.
void supervise(const AvoidanceParameters& p, const View& view, double dt, Guidance& state) {
  state.dwell += dt;
  if (state.dwell < p.dwell) return;
  if (state.avoiding == 0 && must_avoid(p, view)) {
    state.avoiding = 1;
    state.side = rover::wrap(view.goal_bearing - view.obstacle->bearing) < 0.0 ? -1 : 1;
    state.hit_range = view.goal_range;
    state.dwell = 0.0;
  } else if (state.avoiding == 1 && may_go(p, view, state)) {
    state.avoiding = 0;
    state.side = 0;
    state.dwell = 0.0;
  }
}

/// Along the obstacle, turned towards it when too far and away from it when too near.
double tangent(const AvoidanceParameters& p, const View& view, const Guidance& state) {
  const double tilt =
      std::clamp(std::atan2(view.obstacle->range - p.safety_distance, 0.5 * p.safety_distance),
                 -std::numbers::pi / 3.0, std::numbers::pi / 4.0);
  return view.obstacle->bearing + static_cast<double>(state.side) * (kQuarter - tilt);
}

}  // namespace

Velocity avoid(const AvoidanceParameters& p, const Pose2D& pose, const Obstacles& obstacles,
               double dt, Guidance& state) {
  const View view{distance(pose, state.goal), bearing(pose, state.goal), obstacles.nearest()};
  supervise(p, view, dt, state);
  const bool around = state.avoiding == 1 && view.obstacle != nullptr;
  // A core that hands over mid-avoidance may not have chosen a side.
  if (around && state.side == 0) state.side = 1;
  const double wanted = around ? tangent(p, view, state) : view.goal_bearing;
  const double error = rover::wrap(pose.heading - wanted);
  const double speed = p.speed_max * std::min(1.0, std::sqrt(view.goal_range)) *
                       std::max(0.0, std::cos(error)) * (around ? p.avoid_speed : 1.0);
  return {speed, turn_rate(error, p.heading)};
}

}  // namespace guidance
