// SPDX-License-Identifier: LGPL-3.0-or-later
/// One turn of a planar laser scanner: laser_scan/1. Fixed capacity, so it travels without the
/// heap.
#pragma once

#include <cstddef>

#include <mauve/bounded.h>
#include <mauve/type.h>

namespace rover {

/// Ranges in metres, beam i looking along angle_min + i * angle_increment in the robot's frame.
struct LaserScan {
  static constexpr std::size_t kCapacity = 1081;

  double time = 0.0;  ///< s, monotonic clock
  float angle_min = 0.0F;
  float angle_increment = 0.0F;
  float range_min = 0.0F;
  float range_max = 0.0F;
  mauve::Bounded<float, kCapacity> ranges;

  /// A range that is a real return, neither an error code nor "nothing there". [any]
  [[nodiscard]] bool valid(std::size_t beam) const {
    const float range = ranges[beam];
    return range >= range_min && range < range_max;
  }
  /// Direction of a beam in the robot's frame, rad. [any]
  [[nodiscard]] double angle(std::size_t beam) const {
    return static_cast<double>(angle_min) +
           static_cast<double>(beam) * static_cast<double>(angle_increment);
  }

  static constexpr std::string_view type_name = "laser_scan/1";
  static constexpr auto fields() {
    return std::tuple{mauve::field("time", &LaserScan::time, "s", "monotonic clock"),
                      mauve::field("angle_min", &LaserScan::angle_min, "rad"),
                      mauve::field("angle_increment", &LaserScan::angle_increment, "rad"),
                      mauve::field("range_min", &LaserScan::range_min, "m"),
                      mauve::field("range_max", &LaserScan::range_max, "m"),
                      mauve::field("ranges", &LaserScan::ranges, "m", "one for each beam")};
  }
};

}  // namespace rover
