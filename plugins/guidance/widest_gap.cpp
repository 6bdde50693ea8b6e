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
  mauve::Parameters<GapParameters> law{*this};

  Velocity steer(const Pose2D& pose, const Obstacles& /*obstacles*/, double /*dt*/) override {
    Velocity wanted;
    look_at_scan([&](const LaserScan& scan) { wanted = follow_gap(law, pose, scan, *state); });
    return wanted;
  }
};

}  // namespace
}  // namespace guidance

MAUVE_PLUGIN(plugin) { plugin.core<guidance::WidestGap>("widest_gap"); }
