// SPDX-License-Identifier: LGPL-3.0-or-later
/// One line for each file of this plugin that offers something.
#pragma once

#include <mauve/plugin.h>

namespace teleop {

void declare_teleop(mauve::Plugin& plugin);
void declare_priority(mauve::Plugin& plugin);
void declare_joystick(mauve::Plugin& plugin);

}  // namespace teleop
