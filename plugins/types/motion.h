// SPDX-License-Identifier: LGPL-3.0-or-later
/// The inputs and the output of the localization: twist/1, pose/1, motion_state/1. Metres, radians,
/// x east, y north, in the local frame. Times are seconds on the monotonic clock; 0 stands for now.
#pragma once

#include <mauve/type.h>

namespace rover {

/// Measured speeds in the robot's own frame.
struct Twist {
  double time = 0.0;
  double linear = 0.0;   ///< m/s, forward
  double angular = 0.0;  ///< rad/s, anticlockwise

  static constexpr std::string_view type_name = "twist/1";
  static constexpr auto fields() {
    return std::tuple{mauve::field("time", &Twist::time, "s", "monotonic clock; 0: now"),
                      mauve::field("linear", &Twist::linear, "m/s", "forward"),
                      mauve::field("angular", &Twist::angular, "rad/s", "anticlockwise")};
  }
};

/// A measured place, as from satellites.
struct Pose {
  double time = 0.0;
  double x = 0.0;
  double y = 0.0;
  double deviation = 0.0;  ///< m, one sigma along each axis

  static constexpr std::string_view type_name = "pose/1";
  static constexpr auto fields() {
    return std::tuple{
        mauve::field("time", &Pose::time, "s", "monotonic clock; 0: now"),
        mauve::field("x", &Pose::x, "m"), mauve::field("y", &Pose::y, "m"),
        mauve::field("deviation", &Pose::deviation, "m", "one sigma along each axis")};
  }
};

/// An estimate of the motion, with the covariance of its place.
struct MotionState {
  double time = 0.0;  ///< that it is about
  double x = 0.0;
  double y = 0.0;
  double heading = 0.0;
  double linear = 0.0;
  double angular = 0.0;
  double variance_x = 0.0;        ///< m^2
  double variance_y = 0.0;        ///< m^2
  double covariance_xy = 0.0;     ///< m^2
  double variance_heading = 0.0;  ///< rad^2

  static constexpr std::string_view type_name = "motion_state/1";
  static constexpr auto fields() {
    return std::tuple{
        mauve::field("time", &MotionState::time, "s", "monotonic clock; of the motion"),
        mauve::field("x", &MotionState::x, "m"),
        mauve::field("y", &MotionState::y, "m"),
        mauve::field("heading", &MotionState::heading, "rad", "anticlockwise from x"),
        mauve::field("linear", &MotionState::linear, "m/s", "forward"),
        mauve::field("angular", &MotionState::angular, "rad/s", "anticlockwise"),
        mauve::field("variance_x", &MotionState::variance_x, "m2"),
        mauve::field("variance_y", &MotionState::variance_y, "m2"),
        mauve::field("covariance_xy", &MotionState::covariance_xy, "m2"),
        mauve::field("variance_heading", &MotionState::variance_heading, "rad2")};
  }
};

}  // namespace rover
