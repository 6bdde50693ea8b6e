// SPDX-License-Identifier: LGPL-3.0-or-later
#include "progress.h"

namespace supervision {

mauve::Duration stays_for(Progress& progress, const rover::Pose2D& pose, bool wants, double radius,
                          mauve::Instant now) {
  // A distance that is not a number is no progress.
  const bool moved = distance(pose, progress.at) > radius;
  if (!wants || !progress.watched || moved) {
    progress = {{pose.x, pose.y}, now, wants};
  }
  return mauve::Duration{now - progress.since};
}

}  // namespace supervision
