// SPDX-License-Identifier: LGPL-3.0-or-later
/// The way that is being driven, and how far the robot is along it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <mauve/type.h>

#include "../types/grid.h"
#include "../types/pose.h"

namespace navigation {

/// The state that survives a change.
struct Route {
  rover::Path path;
  rover::Point2D goal;
  rover::Point2D from;        ///< where the piece that leads to `next` begins
  std::int32_t next = 0;      ///< way point that is the target
  std::int32_t has_goal = 0;  ///< 1 while a goal is being pursued
  std::int32_t goals_reached = 0;

  [[nodiscard]] std::size_t at() const { return static_cast<std::size_t>(next); }
  [[nodiscard]] bool is_last() const { return at() + 1 >= path.points.size(); }

  static constexpr std::string_view type_name = "route/1";
  static constexpr auto fields() {
    return std::tuple{mauve::field("path", &Route::path),
                      mauve::field("goal", &Route::goal, "m"),
                      mauve::field("from", &Route::from, "m"),
                      mauve::field("next", &Route::next),
                      mauve::field("has_goal", &Route::has_goal),
                      mauve::field("goals_reached", &Route::goals_reached)};
  }
};

/// Distance from the place to the line between two others, ends included. [rt]
[[nodiscard]] inline double distance_beside(const rover::Point2D& from, const rover::Point2D& to,
                                            const rover::Pose2D& at) {
  const double dx = to.x - from.x;
  const double dy = to.y - from.y;
  const double square = dx * dx + dy * dy;
  const double along = square > 0.0 ? ((at.x - from.x) * dx + (at.y - from.y) * dy) / square : 0.0;
  const double share = std::clamp(along, 0.0, 1.0);
  return std::hypot(at.x - from.x - share * dx, at.y - from.y - share * dy);
}

/// Is the place beyond `to`, coming from `from`? [rt]
[[nodiscard]] inline bool is_past(const rover::Point2D& from, const rover::Point2D& to,
                                  const rover::Pose2D& at) {
  return (at.x - to.x) * (to.x - from.x) + (at.y - to.y) * (to.y - from.y) > 0.0;
}

/// Goes on to the way point that the robot should drive to now. That is the next one when this one
/// is within `reach`, or passed, and the next is in sight. A robot right before this one goes on in
/// any case. [rt]
template <typename InSight>
void advance(Route& route, const rover::Pose2D& pose, double reach, InSight in_sight) {
  constexpr double kBeforeIt = 0.2;  // m; the guidance stops a little nearer
  while (!route.is_last()) {
    const rover::Point2D here = route.path.points[route.at()];
    const double left = rover::distance(pose, here);
    const bool reached = left < reach || is_past(route.from, here, pose);
    const rover::Point2D next = route.path.points[route.at() + 1];
    if (left >= kBeforeIt && !(reached && in_sight(next))) return;
    route.from = here;
    ++route.next;
  }
}

}  // namespace navigation
