// SPDX-License-Identifier: LGPL-3.0-or-later
/// Plugin "teleop": a human at a joystick takes the robot over (paper 5.1.2).
#include "parts.h"

MAUVE_PLUGIN(plugin) {
  teleop::declare_teleop(plugin);
  teleop::declare_priority(plugin);
  teleop::declare_joystick(plugin);
}
