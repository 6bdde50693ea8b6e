// SPDX-License-Identifier: LGPL-3.0-or-later
/// One line for each file of this plugin that offers something.
#pragma once

#include <mauve/plugin.h>

namespace navigation {

void declare_map_server(mauve::Plugin& plugin);

}  // namespace navigation
