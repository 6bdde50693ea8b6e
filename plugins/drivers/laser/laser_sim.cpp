// SPDX-License-Identifier: LGPL-3.0-or-later
/// Component kind "drivers/laser_sim": a laser driver on the simulated world; its port `scan` is
/// that of a real one.
#include "../../types/scan.h"
#include "../parts.h"

namespace drivers {
namespace {

using rover::LaserScan;

struct LaserSimShell : mauve::Shell {
  mauve::WritePort<LaserScan> scan{*this, "scan"};
  mauve::ReadPort<LaserScan> world{*this, "world", mauve::Need::required};
};

class LaserSim final : public mauve::Core<LaserSimShell> {
 public:
  void update() {
    if (has_value(shell().world.read(seen_))) shell().scan.write(seen_);
  }

 private:
  mauve::Stateless stateless{*this};
  LaserScan seen_;
};

}  // namespace

void declare_laser_sim(mauve::Plugin& plugin) {
  plugin.component<LaserSimShell, LaserSim, mauve::PeriodicFsm<LaserSim>>("laser_sim");
}

}  // namespace drivers
