// SPDX-License-Identifier: LGPL-3.0-or-later
#include "field.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace guidance {
namespace {

struct Force {
  double x = 0.0;
  double y = 0.0;
};

Force operator+(const Force& a, const Force& b) { return {a.x + b.x, a.y + b.y}; }

Force towards_goal(const FieldParameters& p, const Pose2D& pose, const Point2D& goal) {
  const double range = distance(pose, goal);
  if (range < 1e-9) return {};
  const double pull = p.gain * attraction(range, p);
  return {pull * (goal.x - pose.x) / range, pull * (goal.y - pose.y) / range};
}

/// The obstacle that stands in the way: inside its zone while the pull points at it. Null if none
/// does.
const Obstacle* in_the_way(const FieldParameters& p, const Force& pull,
                           const Obstacles& obstacles) {
  const Obstacle* worst = nullptr;
  for (const Obstacle& obstacle : obstacles) {
    const bool inside = obstacle.range < p.obstacle_distance;
    const bool ahead =
        pull.x * std::cos(obstacle.bearing) + pull.y * std::sin(obstacle.bearing) > 0.0;
    if (inside && ahead && (worst == nullptr || obstacle.range < worst->range)) worst = &obstacle;
  }
  return worst;
}

Force away_from(const FieldParameters& p, const Obstacles& obstacles) {
  Force sum;
  for (const Obstacle& obstacle : obstacles) {
    const double push = repulsion(obstacle.range, p);
    sum = sum + Force{-push * std::cos(obstacle.bearing), -push * std::sin(obstacle.bearing)};
  }
  return sum;
}

/// The bounded extra input: along the obstacle, on the side chosen once.
Force sideways(const FieldParameters& p, const Force& pull, const Obstacle* obstacle,
               Guidance& state) {
  if (obstacle == nullptr) {
    state.side = 0;
    return {};
  }
  const double ox = std::cos(obstacle->bearing);
  const double oy = std::sin(obstacle->bearing);
  if (state.side == 0) state.side = ox * pull.y - oy * pull.x < 0.0 ? -1 : 1;
  const double strength = p.escape * static_cast<double>(state.side);
  return {-strength * oy, strength * ox};
}

}  // namespace

FieldParameters repaired(FieldParameters p) {
  p.nu = std::max(p.nu, 1e-3);
  p.psi = std::max(p.psi, p.nu);
  p.safety_distance = std::max(p.safety_distance, 1e-2);
  p.obstacle_distance = std::max(p.obstacle_distance, 1.25 * p.safety_distance);
  p.safety_distance = std::max(p.safety_distance, p.obstacle_distance / std::numbers::sqrt3);
  return p;
}

double blend(double distance, double nu, double psi) {
  if (distance <= nu) return 1.0;
  if (distance >= psi) return 0.0;
  const double s = distance;
  const double numerator = 2.0 * s * s * s - 3.0 * (psi + nu) * s * s + 6.0 * psi * nu * s +
                           psi * psi * (psi - 3.0 * nu);
  const double width = psi - nu;
  return numerator / (width * width * width);
}

double attraction(double distance, const FieldParameters& p) {
  const double inner = blend(distance, p.nu, p.psi);
  return inner * distance / p.psi + (1.0 - inner);
}

double repulsion(double distance, const FieldParameters& p) {
  const double d2 = p.obstacle_distance * p.obstacle_distance;
  const double depth = d2 - distance * distance;
  if (depth <= 0.0) return 0.0;
  const double rs = p.safety_distance;
  const double four_alpha = p.gain / (rs * (d2 - rs * rs));
  return four_alpha * depth * distance;
}

Velocity follow_field(const FieldParameters& p, const Pose2D& pose, const Obstacles& obstacles,
                      Guidance& state) {
  const Force pull = towards_goal(p, pose, state.goal);
  const Force escape = sideways(p, pull, in_the_way(p, pull, obstacles), state);
  const Force force = pull + away_from(p, obstacles) + escape;
  const double strength = std::hypot(force.x, force.y);
  if (strength < 1e-9) return {};
  const double error = rover::wrap(pose.heading - std::atan2(force.y, force.x));
  const double speed = p.speed * std::min(1.0, strength) * std::max(0.0, std::cos(error));
  return {speed, turn_rate(error, p.heading)};
}

}  // namespace guidance
