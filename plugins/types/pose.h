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
};

/// A place.
struct Point2D {
  double x = 0.0;
  double y = 0.0;
};

/// The measurement of the wheels: the pose dead-reckoned since the start, and the speeds now.
struct Odometry {
  double time = 0.0;  ///< s, monotonic clock
  double x = 0.0;
  double y = 0.0;
  double heading = 0.0;
  double linear = 0.0;   ///< m/s, forward
  double angular = 0.0;  ///< rad/s, anticlockwise
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

template <>
struct mauve::Described<rover::Pose2D> {
  static constexpr std::string_view name = "pose2d/1";
  static constexpr auto fields() {
    using rover::Pose2D;
    return std::tuple{field("x", &Pose2D::x, "m"), field("y", &Pose2D::y, "m"),
                      field("heading", &Pose2D::heading, "rad", "anticlockwise from x")};
  }
};

template <>
struct mauve::Described<rover::Point2D> {
  static constexpr std::string_view name = "point2d/1";
  static constexpr auto fields() {
    using rover::Point2D;
    return std::tuple{field("x", &Point2D::x, "m"), field("y", &Point2D::y, "m")};
  }
};

template <>
struct mauve::Described<rover::Odometry> {
  static constexpr std::string_view name = "odometry/2";
  static constexpr auto fields() {
    using rover::Odometry;
    return std::tuple{field("time", &Odometry::time, "s", "monotonic clock"),
                      field("x", &Odometry::x, "m"),
                      field("y", &Odometry::y, "m"),
                      field("heading", &Odometry::heading, "rad"),
                      field("linear", &Odometry::linear, "m/s", "forward"),
                      field("angular", &Odometry::angular, "rad/s", "anticlockwise")};
  }
};
