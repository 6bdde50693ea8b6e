// SPDX-License-Identifier: LGPL-3.0-or-later
/// Core "guidance_extra/widest_gap": goes in the free direction nearest to the goal. A plugin of
/// its own, so that it can be loaded into a running rover that knew nothing of it:
///   mauvectl load guidance_extra
///   mauvectl swap-core control guidance_extra/widest_gap
#include "gap.h"

#include "control.h"

namespace guidance {
namespace {

class WidestGap final : public GuidanceCore {
  mauve::Property<double> speed{
      *this, "speed", 0.7, "at most", {.unit = "m/s", .min = 0.0, .max = 2.0}};
  mauve::Property<double> clearance{*this,
                                    "clearance",
                                    0.6,
                                    "half width of the way looked for",
                                    {.unit = "m", .min = 0.1, .max = 5.0}};

  mauve::Status on_configure() override {
    law_.speed_max = speed;
    law_.clearance = clearance;
    return mauve::ok();
  }

  Velocity steer(const Pose2D& pose, const Obstacles& /*obstacles*/, double /*dt*/) override {
    Velocity wanted;
    look_at_scan([&](const LaserScan& scan) { wanted = follow_gap(law_, pose, scan, *state); });
    return wanted;
  }

  GapParameters law_;
};

}  // namespace
}  // namespace guidance

MAUVE_PLUGIN(plugin) { plugin.core<guidance::WidestGap>("widest_gap"); }
