// SPDX-License-Identifier: LGPL-3.0-or-later
/// Plugin "guidance": the component kind "guidance/control" and the cores for it.
#include "cores.h"

MAUVE_PLUGIN(plugin) {
  guidance::declare_potential_field(plugin);
  guidance::declare_finite_time(plugin);
  guidance::declare_stop(plugin);
  guidance::declare_mission(plugin);
  plugin.component<guidance::ControlShell, guidance::ControlFsm>("control", "potential_field");
}
