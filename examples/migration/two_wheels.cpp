// SPDX-License-Identifier: LGPL-3.0-or-later
#include "base.h"
#include "controller.h"

MAUVE_PLUGIN(plugin) {
  using namespace two_wheels;
  plugin.type<Pose>();
  plugin.type<Wheels>();
  plugin.core<GoTo>("go_to");
  plugin.core<Stop>("stop");
  plugin.component<ControllerShell, mauve::PeriodicFsm<Controller>>("controller", "go_to");
  plugin.component<BaseShell, Base, mauve::PeriodicFsm<Base>>("base");
}
