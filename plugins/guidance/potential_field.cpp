// SPDX-License-Identifier: LGPL-3.0-or-later
/// Core "guidance/potential_field": pulled by the goal, pushed by obstacles. For clutter and near
/// goals. Example: mauvectl swap-core control guidance/potential_field --set speed=0.4
///
/// The law and where it comes from: field.h. Distances that contradict one another (the published
/// defaults do) are repaired when the core is configured.
#include "cores.h"
#include "field.h"

namespace guidance {
namespace {

class PotentialField final : public GuidanceCore {
  mauve::Parameters<FieldParameters> parameters{*this};

  mauve::Status on_configure() override {
    law_ = repaired(parameters);
    return mauve::ok();
  }

  Velocity steer(const Pose2D& pose, const Obstacles& obstacles, double /*dt*/) override {
    return follow_field(law_, pose, obstacles, *state);
  }

  FieldParameters law_;
};

}  // namespace

void declare_potential_field(mauve::Plugin& plugin) {
  plugin.core<PotentialField>("potential_field");
}

}  // namespace guidance
