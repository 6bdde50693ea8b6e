// SPDX-License-Identifier: LGPL-3.0-or-later
/// One line for each file of this plugin that offers something.
#pragma once

#include <mauve/plugin.h>

namespace ros_bridge {

void declare_publishers(mauve::Plugin& plugin);
void declare_subscribers(mauve::Plugin& plugin);
void declare_relays(mauve::Plugin& plugin);

}  // namespace ros_bridge
