// SPDX-License-Identifier: LGPL-3.0-or-later
/// Gap following as a pure function; the plugin around it is widest_gap.cpp.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <tuple>

#include <mauve/property.h>

#include "../types/scan.h"
#include "guidance.h"

namespace guidance {

struct GapParameters {
  double clearance = 0.6;  ///< half width of a way that is good enough, m
  double horizon = 2.0;    ///< how far it must be free, m
  double speed = 0.7;      ///< m/s
  HeadingLaw heading;

  static auto parameters() {
    using P = GapParameters;
    using mauve::parameter;
    return std::tuple{
        parameter("speed", &P::speed, "at most", {.unit = "m/s", .min = 0.0, .max = 2.0}),
        parameter("clearance", &P::clearance, "half width of the way looked for",
                  {.unit = "m", .min = 0.1, .max = 5.0})};
  }
};

/// How far one can go in a direction before a corridor of that half width meets a return. [rt]
[[nodiscard]] inline double free_along(const rover::LaserScan& scan, double direction,
                                       double half_width, double horizon) {
  constexpr std::size_t kStride = 4;  // two degrees apart: far narrower than any obstacle in reach
  double free = horizon;
  for (std::size_t beam = 0; beam < scan.ranges.size(); beam += kStride) {
    const auto range = static_cast<double>(scan.ranges[beam]);
    if (!scan.valid(beam) || range > horizon + half_width) continue;
    const double angle = scan.angle(beam) - direction;
    const double along = range * std::cos(angle);
    if (along > 0.0 && std::abs(range * std::sin(angle)) < half_width) free = std::min(free, along);
  }
  return free;
}

/// The velocity wanted: towards the free direction that costs the smallest turn away from the goal,
/// with a bias for the heading just held so that it does not waver. [rt]
[[nodiscard]] inline Velocity follow_gap(const GapParameters& p, const Pose2D& pose,
                                         const rover::LaserScan& scan, const Guidance& state) {
  constexpr double kStep = std::numbers::pi / 36.0;
  constexpr int kSide = 24;  // 120 degrees to each side of the robot
  const double to_goal = rover::wrap(bearing(pose, state.goal) - pose.heading);
  const double reach = std::min(p.horizon, distance(pose, state.goal));
  double best_cost = 1e9;
  double best = to_goal;
  const auto consider = [&](double direction) {
    const double free = free_along(scan, direction, p.clearance, reach);
    const double cost = std::abs(rover::wrap(direction - to_goal)) + 0.3 * std::abs(direction) +
                        4.0 * (reach - free);
    if (cost < best_cost) {
      best_cost = cost;
      best = direction;
    }
  };
  consider(to_goal);
  for (int i = -kSide; i <= kSide; ++i) consider(kStep * i);
  const double error = rover::wrap(-best);
  const double ahead = free_along(scan, 0.0, 0.4, p.horizon);
  const double speed = p.speed * std::min(1.0, std::sqrt(distance(pose, state.goal))) *
                       std::max(0.0, std::cos(error)) * std::clamp(ahead - 0.3, 0.0, 1.0);
  return {speed, turn_rate(error, p.heading)};
}

}  // namespace guidance
