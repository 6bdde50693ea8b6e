// SPDX-License-Identifier: LGPL-3.0-or-later
/// Where something is in the plane: pose2d/1, point2d/1, odometry/2. Metres, radians, x east.
#pragma once

#include <cmath>
#include <numbers>

#include <mauve/type.h>

namespace rover {

/// A place and a direction; heading is counted anticlockwise from x, in (-pi, pi].
struct Pose2D {
  double x = 0.0;
  double y = 0.0;
  double heading = 0.0;

  static constexpr std::string_view type_name = "pose2d/1";
  static constexpr auto fields() {
    return std::tuple{mauve::field("x", &Pose2D::x, "m"), mauve::field("y", &Pose2D::y, "m"),
                      mauve::field("heading", &Pose2D::heading, "rad", "anticlockwise from x")};
  }
};

/// A place.
struct Point2D {
  double x = 0.0;
  double y = 0.0;

  static constexpr std::string_view type_name = "point2d/1";
  static constexpr auto fields() {
    return std::tuple{mauve::field("x", &Point2D::x, "m"), mauve::field("y", &Point2D::y, "m")};
  }
};

/// The measurement of the wheels: the pose dead-reckoned since the start, and the speeds now.
struct Odometry {
  double time = 0.0;  ///< s, monotonic clock
  double x = 0.0;
  double y = 0.0;
  double heading = 0.0;
  double linear = 0.0;   ///< m/s, forward
  double angular = 0.0;  ///< rad/s, anticlockwise

  static constexpr std::string_view type_name = "odometry/2";
  static constexpr auto fields() {
    return std::tuple{mauve::field("time", &Odometry::time, "s", "monotonic clock"),
                      mauve::field("x", &Odometry::x, "m"),
                      mauve::field("y", &Odometry::y, "m"),
                      mauve::field("heading", &Odometry::heading, "rad"),
                      mauve::field("linear", &Odometry::linear, "m/s", "forward"),
                      mauve::field("angular", &Odometry::angular, "rad/s", "anticlockwise")};
  }
};

/// The same angle in [-pi, pi]. [any]
[[nodiscard]] inline double wrap(double angle) {
  return std::remainder(angle, 2.0 * std::numbers::pi);
}

/// Direction from the pose's place to the point, in the world. [any]
[[nodiscard]] inline double bearing(const Pose2D& from, const Point2D& to) {
  return std::atan2(to.y - from.y, to.x - from.x);
}

/// Distance in metres. [any]
[[nodiscard]] inline double distance(const Pose2D& from, const Point2D& to) {
  return std::hypot(to.x - from.x, to.y - from.y);
}

}  // namespace rover
