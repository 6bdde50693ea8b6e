// SPDX-License-Identifier: LGPL-3.0-or-later
/// Plugin "localization": where the robot is, from wheels, gyroscope, compass and satellites.
#include "ekf_resource.h"
#include "gnss_to_utm.h"

MAUVE_PLUGIN(plugin) {
  using namespace localization;
  plugin.resource<mauve::EmptyShell, EkfCore, EkfInterface>("ekf");
  plugin.resource<GnssToUtmShell, GnssToUtmCore, GnssToUtmInterface>("gnss_to_utm");
}
