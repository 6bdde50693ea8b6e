// SPDX-License-Identifier: LGPL-3.0-or-later
#include "zones.h"

#include <algorithm>
#include <cmath>

namespace safety {

double free_way(const rover::LaserScan& scan, double half_width) {
  double nearest = static_cast<double>(scan.range_max);
  for (std::size_t beam = 0; beam < scan.ranges.size(); ++beam) {
    const auto range = static_cast<double>(scan.ranges[beam]);
    if (!scan.valid(beam) || range >= nearest) continue;
    const double angle = scan.angle(beam);
    const bool ahead = std::cos(angle) > 0.0;
    if (ahead && std::abs(range * std::sin(angle)) <= half_width) nearest = range;
  }
  return nearest;
}

bool blind(const rover::LaserScan& scan) {
  if (!std::isfinite(scan.angle_min) || !std::isfinite(scan.angle_increment)) return true;
  if (!(scan.range_max > scan.range_min)) return true;
  return std::none_of(scan.ranges.begin(), scan.ranges.end(),
                      [&scan](float range) { return range >= scan.range_min; });
}

Zone next_zone(Zone before, double free_way, const Limits& limits) {
  const auto within = [&](double distance, Zone zone) {
    return free_way < distance * (before >= zone ? 1.0 + limits.hysteresis : 1.0);
  };
  if (within(limits.stop_distance, Zone::stop)) return Zone::stop;
  return within(limits.slow_distance, Zone::slow) ? Zone::slow : Zone::clear;
}

rover::Velocity limited(const rover::Velocity& command, Zone zone) {
  if (!std::isfinite(command.linear) || !std::isfinite(command.angular)) return {};
  rover::Velocity safe = command;
  if (zone == Zone::slow && safe.linear > 0.0) safe.linear *= 0.5;
  if (zone == Zone::stop) safe.linear = std::min(safe.linear, 0.0);
  return safe;
}

}  // namespace safety
