// SPDX-License-Identifier: LGPL-3.0-or-later
/// Core "guidance/finite_time": straight to the goal, round what is in the way. For open ground and
/// distant goals. Example: mauvectl swap-core control guidance/finite_time --set speed=1.0
///
/// The law and where it comes from: avoidance.h.
#include "avoidance.h"
#include "cores.h"

namespace guidance {
namespace {

class FiniteTime final : public GuidanceCore {
  mauve::Property<double> obstacle_distance{*this,
                                            "obstacle_distance",
                                            1.2,
                                            "avoiding starts here",
                                            {.unit = "m", .min = 0.1, .max = 10.0}};
  mauve::Property<double> safety_distance{*this,
                                          "safety_distance",
                                          0.7,
                                          "kept while going round",
                                          {.unit = "m", .min = 0.1, .max = 10.0}};
  mauve::Property<double> speed{
      *this, "speed", 0.8, "at most", {.unit = "m/s", .min = 0.0, .max = 2.0}};
  mauve::Property<mauve::Duration> dwell{
      *this, "dwell", 500ms, "between two decisions", {.min = 0ms, .max = 10s}};

  mauve::Status on_configure() override {
    if (safety_distance >= obstacle_distance) {
      return mauve::invalid(safety_distance, "must be below obstacle_distance");
    }
    law_.obstacle_distance = obstacle_distance;
    law_.safety_distance = safety_distance;
    law_.speed_max = speed;
    law_.dwell = std::chrono::duration<double>(dwell.get()).count();
    return mauve::ok();
  }

  Velocity steer(const Pose2D& pose, const Obstacles& obstacles, double dt) override {
    return avoid(law_, pose, obstacles, dt, *state);
  }

  AvoidanceParameters law_;
};

}  // namespace

void declare_finite_time(mauve::Plugin& plugin) { plugin.core<FiniteTime>("finite_time"); }

}  // namespace guidance
