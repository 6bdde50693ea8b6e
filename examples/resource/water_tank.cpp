// SPDX-License-Identifier: LGPL-3.0-or-later
#include "water_tank.h"

#include "filler.h"

MAUVE_PLUGIN(plugin) {
  plugin.resource<mauve::EmptyShell, water_tank::Tank, water_tank::Services>("tank");
  plugin.component<water_tank::FillerShell, water_tank::Filler,
                   mauve::PeriodicFsm<water_tank::Filler>>("filler");
}
