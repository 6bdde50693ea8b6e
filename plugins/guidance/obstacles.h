// SPDX-License-Identifier: LGPL-3.0-or-later
/// From a laser scan to the few points that matter: the nearest one of each thing in sight.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "../types/pose.h"
#include "../types/scan.h"

namespace guidance {

/// The nearest point of a group of neighbouring returns, in the world's frame.
struct Obstacle {
  rover::Point2D at;
  double range = 0.0;    ///< m from the laser
  double bearing = 0.0;  ///< rad, direction in the world
};

/// At most kCapacity of them; when there are more, those farthest to the left are left out.
struct Obstacles {
  static constexpr std::size_t kCapacity = 64;

  std::array<Obstacle, kCapacity> found{};
  std::size_t size = 0;

  [[nodiscard]] const Obstacle* begin() const { return found.data(); }
  [[nodiscard]] const Obstacle* end() const { return found.data() + size; }
  /// The one nearest to the robot, null when nothing is in sight. [rt]
  [[nodiscard]] const Obstacle* nearest() const {
    const auto nearer = [](const Obstacle& a, const Obstacle& b) { return a.range < b.range; };
    const Obstacle* best = std::min_element(begin(), end(), nearer);
    return best == end() ? nullptr : best;
  }
};

/// The return of one beam. [rt]
[[nodiscard]] inline Obstacle seen(const rover::LaserScan& scan, const rover::Pose2D& pose,
                                   std::size_t beam) {
  const double range = static_cast<double>(scan.ranges[beam]);
  const double direction = rover::wrap(pose.heading + scan.angle(beam));
  return {{pose.x + range * std::cos(direction), pose.y + range * std::sin(direction)},
          range,
          direction};
}

/// Groups the returns nearer than `limit`: a new group begins where the range jumps by more than
/// `gap` or a beam has no return. Fills `out`. [rt]
inline void nearest_points(const rover::LaserScan& scan, const rover::Pose2D& pose, double limit,
                           Obstacles& out, double gap = 0.3) {
  constexpr std::size_t kNone = rover::LaserScan::kCapacity;
  const std::size_t beams = scan.ranges.size();
  out.size = 0;
  std::size_t nearest = kNone;
  float last = 0.0F;
  const auto close_group = [&] {
    if (nearest != kNone && out.size < Obstacles::kCapacity) {
      out.found[out.size++] = seen(scan, pose, nearest);
    }
    nearest = kNone;
  };
  for (std::size_t beam = 0; beam < beams; ++beam) {
    const float range = scan.ranges[beam];
    const bool counts = scan.valid(beam) && static_cast<double>(range) < limit;
    if (!counts || std::abs(static_cast<double>(range - last)) > gap) close_group();
    if (!counts) continue;
    if (nearest == kNone || range < scan.ranges[nearest]) nearest = beam;
    last = range;
  }
  close_group();
}

}  // namespace guidance
