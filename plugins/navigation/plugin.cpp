// SPDX-License-Identifier: LGPL-3.0-or-later
/// Plugin "navigation": a map, and the way through it.
#include "navigation.h"
#include "parts.h"

MAUVE_PLUGIN(plugin) {
  navigation::declare_map_server(plugin);
  plugin.component<navigation::NavigationShell, navigation::Navigation, navigation::NavigationFsm>(
      "navigation");
}
