// SPDX-License-Identifier: LGPL-3.0-or-later
/// Finite-time avoidance as a pure function; the plugin around it is finite_time.cpp.
///
/// A reconstruction from the known parts of Guerra, Efimov, Zheng, Perruquetti (Autonomous Robots
/// 41, 2017). It has a unicycle with disturbed inputs and a supervisor over two controls. Every law
/// regulates the heading in finite time.
///
///   `GO`     straight to the goal, until an obstacle nearer than d_obs would be passed within
///            d_safe.
///   `AVOID`  along that obstacle at d_safe, on one chosen side, and past obstacles beside it too.
///            The distance is as small as squeeze * d_safe where there is no other way on (a door).
///            AVOID lasts until the way to the goal is free again and the robot is nearer to it
///            than at the start. It goes the other way round when this one leads away.
#pragma once

#include <tuple>

#include <mauve/property.h>

#include "guidance.h"
#include "obstacles.h"

namespace guidance {

struct AvoidanceParameters {
  double obstacle_distance = 1.2;      ///< d_obs, avoiding starts inside it, m
  double safety_distance = 0.7;        ///< d_safe, kept while going round, m
  double squeeze = 0.7;                ///< share of d_safe kept where there is no other way
  double speed = 0.8;                  ///< m/s
  double avoid_speed = 0.7;            ///< share of the speed while avoiding
  mauve::Duration dwell{500'000'000};  ///< between two decisions of the supervisor
  double hysteresis = 1.15;            ///< leave when the obstacle is farther than this times d_obs
  HeadingLaw heading;

  static auto parameters() {
    using P = AvoidanceParameters;
    using mauve::parameter;
    return std::tuple{
        parameter("obstacle_distance", &P::obstacle_distance, "avoiding starts here",
                  {.unit = "m", .min = 0.1, .max = 10.0}),
        parameter("safety_distance", &P::safety_distance, "kept while going round",
                  {.unit = "m", .min = 0.1, .max = 10.0}),
        parameter("speed", &P::speed, "at most", {.unit = "m/s", .min = 0.0, .max = 2.0}),
        parameter("dwell", &P::dwell, "between two decisions",
                  {.min = std::chrono::seconds(0), .max = std::chrono::seconds(10)})};
  }
};

/// The velocity wanted at this pose, before slew limits. `dt` is the time since the last step, s.
/// [rt]
[[nodiscard]] Velocity avoid(const AvoidanceParameters& parameters, const Pose2D& pose,
                             const Obstacles& obstacles, double dt, Guidance& state);

}  // namespace guidance
