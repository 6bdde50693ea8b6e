// SPDX-License-Identifier: LGPL-3.0-or-later
#include "obstacles.h"

#include <algorithm>
#include <cmath>

namespace guidance {
namespace {

Obstacle seen(const rover::LaserScan& scan, const rover::Pose2D& pose, std::size_t beam) {
  const double range = static_cast<double>(scan.ranges[beam]);
  const double direction = rover::wrap(pose.heading + scan.angle(beam));
  return {{pose.x + range * std::cos(direction), pose.y + range * std::sin(direction)},
          range,
          direction};
}

}  // namespace

const Obstacle* Obstacles::nearest() const {
  const auto* best = std::min_element(
      begin(), end(), [](const Obstacle& a, const Obstacle& b) { return a.range < b.range; });
  return best == end() ? nullptr : best;
}

void nearest_points(const rover::LaserScan& scan, const rover::Pose2D& pose, double limit,
                    Obstacles& out, double gap) {
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
