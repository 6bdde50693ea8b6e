// SPDX-License-Identifier: LGPL-3.0-or-later
/// Plugin "ros": topics of ROS 1 as resources (paper 3.5, Listing 4, and 5.1.2).
#include "parts.h"

MAUVE_PLUGIN(plugin) {
  ros_bridge::declare_publishers(plugin);
  ros_bridge::declare_subscribers(plugin);
  ros_bridge::declare_relays(plugin);
}
