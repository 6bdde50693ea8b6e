// SPDX-License-Identifier: LGPL-3.0-or-later
/// In which of some rectangles is the robot?
#pragma once

#include <span>

#include <mauve/time.h>

#include "../types/pose.h"

namespace supervision {

/// A rectangle along the axes, its corners included. Metres.
struct Area {
  rover::Point2D low;
  rover::Point2D high;
};

constexpr int kNowhere = -1;  ///< the place of the robot is unknown
constexpr int kOutside = 0;   ///< in none of the areas

/// The number of the first area that holds the pose, from 1. The area `before` is left only when
/// the pose is `margin` metres outside of it, so that a robot on a border does not change its area
/// all the time. The result is kNowhere for a pose that is not a number. [rt]
[[nodiscard]] int area_of(const rover::Pose2D& pose, std::span<const Area> areas, int before,
                          double margin);

/// The area in which the robot was seen last, and when.
struct Sighting {
  int area = kNowhere;
  mauve::Instant time = 0;
};

/// The area of a robot whose pose lies in `area` now, or is not known (kNowhere). While the pose is
/// not known, the robot counts as in its last area, for `remember` at most. The reason is a short
/// pause of the whole machine, which leaves the pose unknown for some jobs. [rt]
[[nodiscard]] int follow(Sighting& last, int area, mauve::Duration remember, mauve::Instant now);

}  // namespace supervision
