// SPDX-License-Identifier: LGPL-3.0-or-later
/// The robot counts on the monotonic clock, ROS on the wall's.
#pragma once

#include <cmath>
#include <cstdint>

#include <mauve/time.h>

namespace ros_bridge {

constexpr std::int64_t kNanoseconds = 1'000'000'000;

/// Both clocks at one instant.
struct Clocks {
  std::int64_t monotonic = 0;
  std::int64_t wall = 0;
};

/// An instant of the robot as ROS's nanoseconds; never before 1970, nor after its 32 bits end.
[[nodiscard]] inline std::int64_t to_wall(mauve::Instant stamp, const Clocks& now) {
  const std::int64_t wall = now.wall + (stamp - now.monotonic);
  const std::int64_t last = std::int64_t{0xffffffff} * kNanoseconds;
  return wall < 0 ? 0 : wall > last ? last : wall;
}

/// A stamp of ROS as seconds on the monotonic clock. None (0), or one that is more than ten seconds
/// off, as of another machine or a simulation: the time it came.
[[nodiscard]] inline double to_seconds(std::int64_t stamp, const Clocks& now) {
  constexpr std::int64_t kFar = 10 * kNanoseconds;
  const std::int64_t age = now.wall - stamp;
  const bool usable = stamp != 0 && age < kFar && age > -kFar;
  return static_cast<double>(usable ? now.monotonic - age : now.monotonic) / 1e9;
}

}  // namespace ros_bridge
