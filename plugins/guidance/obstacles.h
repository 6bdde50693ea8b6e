// SPDX-License-Identifier: LGPL-3.0-or-later
/// From a laser scan to the few points that matter: the nearest one of each thing in sight.
#pragma once

#include <array>
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
  [[nodiscard]] const Obstacle* nearest() const;
};

/// Groups the returns nearer than `limit`: a new group begins where the range jumps by more than
/// `gap` or a beam has no return. Fills `out`. [rt]
void nearest_points(const rover::LaserScan& scan, const rover::Pose2D& pose, double limit,
                    Obstacles& out, double gap = 0.3);

}  // namespace guidance
