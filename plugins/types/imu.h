// SPDX-License-Identifier: LGPL-3.0-or-later
/// The measurement of an inertial measurement unit on a ground robot: imu/1.
#pragma once

#include <cstdint>

#include <mauve/type.h>

namespace rover {

/// One measurement in the robot's frame: x forward, y left.
struct Imu {
  double time = 0.0;            ///< s, monotonic clock; 0: the reader's now
  double yaw_rate = 0.0;        ///< rad/s, anticlockwise
  double acceleration_x = 0.0;  ///< m/s^2
  double acceleration_y = 0.0;  ///< m/s^2
  double heading = 0.0;         ///< rad, anticlockwise from east; only with has_heading
  bool has_heading = false;     ///< its compass is trusted

  static constexpr std::string_view type_name = "imu/1";
  static constexpr auto fields() {
    return std::tuple{mauve::field("time", &Imu::time, "s", "monotonic clock; 0: now"),
                      mauve::field("yaw_rate", &Imu::yaw_rate, "rad/s", "anticlockwise"),
                      mauve::field("acceleration_x", &Imu::acceleration_x, "m/s2", "forward"),
                      mauve::field("acceleration_y", &Imu::acceleration_y, "m/s2", "to the left"),
                      mauve::field("heading", &Imu::heading, "rad", "anticlockwise from east"),
                      mauve::field("has_heading", &Imu::has_heading)};
  }
};

}  // namespace rover
