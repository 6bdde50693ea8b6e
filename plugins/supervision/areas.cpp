// SPDX-License-Identifier: LGPL-3.0-or-later
#include "areas.h"

#include <cmath>
#include <cstddef>

namespace supervision {
namespace {

bool holds(const Area& area, const rover::Pose2D& pose, double margin) {
  return pose.x >= area.low.x - margin && pose.x <= area.high.x + margin &&
         pose.y >= area.low.y - margin && pose.y <= area.high.y + margin;
}

}  // namespace

int area_of(const rover::Pose2D& pose, std::span<const Area> areas, int before, double margin) {
  if (!std::isfinite(pose.x) || !std::isfinite(pose.y)) return kNowhere;
  const auto count = static_cast<int>(areas.size());
  if (before > kOutside && before <= count &&
      holds(areas[static_cast<std::size_t>(before - 1)], pose, margin)) {
    return before;
  }
  for (int i = 0; i < count; ++i) {
    if (holds(areas[static_cast<std::size_t>(i)], pose, 0.0)) return i + 1;
  }
  return kOutside;
}

int follow(Sighting& last, int area, mauve::Duration remember, mauve::Instant now) {
  if (area != kNowhere) {
    last = {area, now};
  } else if (now - last.time >= remember.count()) {
    last.area = kNowhere;
  }
  return last.area;
}

}  // namespace supervision
