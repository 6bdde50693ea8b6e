// SPDX-License-Identifier: LGPL-3.0-or-later
/// Core "guidance/stop": brings the robot to a stand and keeps it there. For want of anything
/// better. Example: mauvectl swap-core control guidance/stop
#include "cores.h"

namespace guidance {
namespace {

class Stop final : public GuidanceCore {
  Velocity steer(const Pose2D& /*pose*/, const Obstacles& /*obstacles*/, double /*dt*/) override {
    return {};
  }
};

}  // namespace

void declare_stop(mauve::Plugin& plugin) { plugin.core<Stop>("stop"); }

}  // namespace guidance
