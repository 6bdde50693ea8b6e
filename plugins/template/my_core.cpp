// SPDX-License-Identifier: LGPL-3.0-or-later
/// Copy this folder, rename it, write your law. Core "my_core/straight": drives straight to the
/// goal, and along what is in the way. Try it on a running rover:
///   mauvectl load my_core
///   mauvectl swap-core control my_core/straight --set speed=0.4
#include <mauve/plugin.h>

#include <mauve-plugins/guidance/control.h>  // ControlShell (ports) and GuidanceCore (the contract)

namespace my_core {

class Straight final : public guidance::GuidanceCore {
  mauve::Property<double> speed{
      *this, "speed", 0.3, "at most", {.unit = "m/s", .min = 0.0, .max = 1.0}};

  // [rt] Every 10 ms on the way to a goal: no heap, no lock, no file, no print here.
  guidance::Velocity steer(const guidance::Pose2D& pose, const guidance::Obstacles& obstacles,
                           double /*dt*/) override {
    double heading = rover::bearing(pose, state->goal);
    const guidance::Obstacle* obstacle = obstacles.nearest();
    if (obstacle != nullptr && obstacle->range < 0.9) {
      constexpr double kSideways = 1.8;  // rad, and a little away from it
      const double side = rover::wrap(heading - obstacle->bearing);
      if (std::abs(side) < kSideways) heading = obstacle->bearing + std::copysign(kSideways, side);
    }
    const double error = rover::wrap(pose.heading - heading);
    const double forward = speed * std::max(0.0, std::cos(error));
    return {forward, guidance::turn_rate(error, guidance::HeadingLaw{})};
  }
};

}  // namespace my_core

MAUVE_PLUGIN(plugin) { plugin.core<my_core::Straight>("straight"); }
