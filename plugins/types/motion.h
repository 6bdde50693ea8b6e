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
};

/// A measured place, as from satellites.
struct Pose {
  double time = 0.0;
  double x = 0.0;
  double y = 0.0;
  double deviation = 0.0;  ///< m, one sigma along each axis
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
};

}  // namespace rover

template <>
struct mauve::Described<rover::Twist> {
  static constexpr std::string_view name = "twist/1";
  static constexpr auto fields() {
    using rover::Twist;
    return std::tuple{field("time", &Twist::time, "s", "monotonic clock; 0: now"),
                      field("linear", &Twist::linear, "m/s", "forward"),
                      field("angular", &Twist::angular, "rad/s", "anticlockwise")};
  }
};

template <>
struct mauve::Described<rover::Pose> {
  static constexpr std::string_view name = "pose/1";
  static constexpr auto fields() {
    using rover::Pose;
    return std::tuple{field("time", &Pose::time, "s", "monotonic clock; 0: now"),
                      field("x", &Pose::x, "m"), field("y", &Pose::y, "m"),
                      field("deviation", &Pose::deviation, "m", "one sigma along each axis")};
  }
};

template <>
struct mauve::Described<rover::MotionState> {
  static constexpr std::string_view name = "motion_state/1";
  static constexpr auto fields() {
    using rover::MotionState;
    return std::tuple{field("time", &MotionState::time, "s", "monotonic clock; of the motion"),
                      field("x", &MotionState::x, "m"),
                      field("y", &MotionState::y, "m"),
                      field("heading", &MotionState::heading, "rad", "anticlockwise from x"),
                      field("linear", &MotionState::linear, "m/s", "forward"),
                      field("angular", &MotionState::angular, "rad/s", "anticlockwise"),
                      field("variance_x", &MotionState::variance_x, "m2"),
                      field("variance_y", &MotionState::variance_y, "m2"),
                      field("covariance_xy", &MotionState::covariance_xy, "m2"),
                      field("variance_heading", &MotionState::variance_heading, "rad2")};
  }
};
