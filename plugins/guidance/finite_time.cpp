// SPDX-License-Identifier: LGPL-3.0-or-later
/// Core "guidance/finite_time": straight to the goal, round obstacles in the way. For open ground
/// and distant goals. Example: mauvectl swap-core control guidance/finite_time --set speed=1.0
///
/// The law and its source: avoidance.h.
#include "avoidance.h"
#include "cores.h"

namespace guidance {
namespace {

class FiniteTime final : public GuidanceCore {
  mauve::Parameters<AvoidanceParameters> law{*this};

  mauve::Status on_configure() override {
    if (law->safety_distance < law->obstacle_distance) return mauve::ok();
    return mauve::invalid(law[&AvoidanceParameters::safety_distance],
                          "must be below obstacle_distance");
  }

  Velocity steer(const Pose2D& pose, const Obstacles& obstacles, double dt) override {
    return avoid(law, pose, obstacles, dt, *state);
  }
};

}  // namespace

void declare_finite_time(mauve::Plugin& plugin) { plugin.core<FiniteTime>("finite_time"); }

}  // namespace guidance
