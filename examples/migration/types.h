// SPDX-License-Identifier: LGPL-3.0-or-later
/// The data that travels between the controller and the base: two_wheels_pose/1,
/// two_wheels_speeds/1.
#pragma once

#include <mauve/type.h>

namespace two_wheels {

struct Pose {
  double x = 0.0;        ///< m
  double y = 0.0;        ///< m
  double heading = 0.0;  ///< rad, anticlockwise from x

  static constexpr std::string_view type_name = "two_wheels_pose/1";
  static constexpr auto fields() {
    return std::tuple{mauve::field("x", &Pose::x, "m"), mauve::field("y", &Pose::y, "m"),
                      mauve::field("heading", &Pose::heading, "rad", "anticlockwise from x")};
  }
};

/// Speeds of the wheels on the ground.
struct Wheels {
  double left = 0.0;   ///< m/s
  double right = 0.0;  ///< m/s

  static constexpr std::string_view type_name = "two_wheels_speeds/1";
  static constexpr auto fields() {
    return std::tuple{mauve::field("left", &Wheels::left, "m/s"),
                      mauve::field("right", &Wheels::right, "m/s")};
  }
};

inline constexpr double kTrack = 0.3;  // m, between the wheels

}  // namespace two_wheels
