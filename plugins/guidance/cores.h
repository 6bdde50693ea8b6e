// SPDX-License-Identifier: LGPL-3.0-or-later
/// One line for each file of this plugin that offers something.
#pragma once

#include "control.h"

namespace guidance {

void declare_potential_field(mauve::Plugin& plugin);
void declare_finite_time(mauve::Plugin& plugin);
void declare_stop(mauve::Plugin& plugin);
void declare_mission(mauve::Plugin& plugin);

}  // namespace guidance
