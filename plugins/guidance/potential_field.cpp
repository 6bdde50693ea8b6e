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
  mauve::Property<double> gain{
      *this, "gain", 1.0, "strength of the pull", {.min = 0.01, .max = 10.0}};
  mauve::Property<double> nu{
      *this, "nu", 0.2, "inside it the pull fades", {.unit = "m", .min = 0.0}};
  mauve::Property<double> psi{
      *this, "psi", 1.0, "beyond it the pull is full", {.unit = "m", .min = 0.0}};
  mauve::Property<double> obstacle_distance{*this,
                                            "obstacle_distance",
                                            0.8,
                                            "the push starts here",
                                            {.unit = "m", .min = 0.1, .max = 10.0}};
  mauve::Property<double> safety_distance{
      *this, "safety_distance", 0.6, "nearest approach", {.unit = "m", .min = 0.1, .max = 10.0}};
  mauve::Property<double> escape{
      *this, "escape", 0.6, "sideways input that leaves a dead end", {.min = 0.0, .max = 1.0}};
  mauve::Property<double> speed{
      *this, "speed", 0.6, "at most", {.unit = "m/s", .min = 0.0, .max = 2.0}};

  mauve::Status on_configure() override {
    law_.nu = nu;
    law_.psi = psi;
    law_.obstacle_distance = obstacle_distance;
    law_.safety_distance = safety_distance;
    law_.gain = gain;
    law_.escape = escape;
    law_.speed_max = speed;
    law_ = repaired(law_);
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
