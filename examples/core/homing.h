// SPDX-License-Identifier: LGPL-3.0-or-later
/// Core "homing/straight" of component kind "guidance/control": it drives straight to the goal, and
/// along an obstacle that is in the way.
#pragma once

#include <mauve-plugins/guidance/control.h>  // ControlShell (ports) and GuidanceCore (contract)

namespace homing {

class Straight final : public guidance::GuidanceCore {
  mauve::Property<double> speed{
      *this, "speed", 0.3, "at most", {.unit = "m/s", .min = 0.0, .max = 1.0}};

  /// [rt] Every 10 ms while there is a goal: no heap, no lock, no file, no print.
  guidance::Velocity steer(const guidance::Pose2D& pose, const guidance::Obstacles& obstacles,
                           double /*dt*/) override {
    double heading = rover::bearing(pose, state->goal);
    const guidance::Obstacle* obstacle = obstacles.nearest();
    if (obstacle != nullptr && obstacle->range < 0.9) {
      constexpr double kSideways = 1.8;  // rad: along the obstacle, and a little away from it
      const double side = rover::wrap(heading - obstacle->bearing);
      if (std::abs(side) < kSideways) heading = obstacle->bearing + std::copysign(kSideways, side);
    }
    const double error = rover::wrap(pose.heading - heading);
    return {speed * std::max(0.0, std::cos(error)), guidance::turn_rate(error, {})};
  }
};

}  // namespace homing
