// SPDX-License-Identifier: LGPL-3.0-or-later
/// Does the robot get on?
#pragma once

#include <mauve/time.h>

#include "../types/pose.h"

namespace supervision {

/// Where the robot was last seen to move, and when.
struct Progress {
  rover::Point2D at;
  mauve::Instant since = 0;
  bool watched = false;
};

/// How long the robot, which wants to move, has been within `radius` metres of one place; nothing
/// while it does not want to. [rt]
[[nodiscard]] mauve::Duration stays_for(Progress& progress, const rover::Pose2D& pose, bool wants,
                                        double radius, mauve::Instant now);

}  // namespace supervision
