// SPDX-License-Identifier: LGPL-3.0-or-later
/// The state that all guidance cores hand over in a swap, and the last step of every law.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <mauve/time.h>
#include <mauve/type.h>

#include "../types/pose.h"
#include "../types/velocity.h"

namespace guidance {

using rover::Point2D;
using rover::Pose2D;
using rover::Velocity;

/// The state that survives a change of core: the goal of the robot and its present motion. So the
/// new law goes on from the very command that the old one gave.
struct Guidance {
  Point2D goal;
  Velocity command;           ///< the last one given
  std::int32_t has_goal = 0;  ///< 1 while a goal is being pursued
  std::int32_t side = 0;      ///< way round the obstacle: +1 leave it right, -1 left, 0 undecided
  std::int32_t avoiding = 0;  ///< 1 while the supervisor of finite_time is in AVOID
  std::int32_t goals_reached = 0;
  double hit_range = 0.0;  ///< m to the goal when AVOID was entered
  double dwell = 0.0;      ///< s since the supervisor last decided

  static constexpr std::string_view type_name = "guidance/2";
  static constexpr auto fields() {
    return std::tuple{mauve::field("goal", &Guidance::goal, "m"),
                      mauve::field("command", &Guidance::command),
                      mauve::field("has_goal", &Guidance::has_goal),
                      mauve::field("side", &Guidance::side),
                      mauve::field("avoiding", &Guidance::avoiding),
                      mauve::field("goals_reached", &Guidance::goals_reached),
                      mauve::field("hit_range", &Guidance::hit_range, "m"),
                      mauve::field("dwell", &Guidance::dwell, "s")};
  }
};

/// Another goal, while driving: a robot that is going round an obstacle decides anew. A goal that
/// only moves a little is the same one. [rt]
inline void aim_at(const Point2D& goal, Guidance& state) {
  constexpr double kSame = 0.2;     // m
  constexpr double kLongAgo = 1e3;  // s
  const bool other = std::hypot(goal.x - state.goal.x, goal.y - state.goal.y) > kSame;
  if (other && state.avoiding == 1) {
    state.side = 0;
    state.avoiding = 0;
    state.dwell = kLongAgo;
  }
  state.goal = goal;
}

/// Turns the heading error into a turn rate that reaches zero error in finite time.
struct HeadingLaw {
  double gain = 2.0;      ///< k, reaches the layer within 2 sqrt(|e0|) / k
  double margin = 0.3;    ///< rho, above the disturbance of the turn rate, rad/s
  double layer = 0.05;    ///< eps, rad: inside it the margin fades, so it does not chatter
  double turn_max = 1.5;  ///< rad/s
};

/// omega = -k sqrt|e| sgn(e) - rho sat(e / eps), limited to turn_max. [rt]
[[nodiscard]] inline double turn_rate(double heading_error, const HeadingLaw& law) {
  const double pull = law.gain * std::sqrt(std::abs(heading_error));
  const double push = law.margin * std::clamp(heading_error / law.layer, -1.0, 1.0);
  return std::clamp(-std::copysign(pull, heading_error) - push, -law.turn_max, law.turn_max);
}

/// How fast a command may change.
struct SlewLimits {
  double speed_up = 1.5;   ///< m/s^2
  double slow_down = 3.0;  ///< m/s^2
  double turn = 20.0;      ///< rad/s^2
};

/// `wanted`, brought within the limits of one step of `dt` seconds after `last`. [rt]
[[nodiscard]] inline Velocity slewed(const Velocity& last, const Velocity& wanted,
                                     const SlewLimits& limits, double dt) {
  // Slowing down towards zero may be quicker than picking up speed, in either direction of travel.
  const bool slower = std::abs(wanted.linear) < std::abs(last.linear);
  const double speed_step = (slower ? limits.slow_down : limits.speed_up) * dt;
  const double turn_step = limits.turn * dt;
  return {std::clamp(wanted.linear, last.linear - speed_step, last.linear + speed_step),
          std::clamp(wanted.angular, last.angular - turn_step, last.angular + turn_step)};
}

}  // namespace guidance
