// SPDX-License-Identifier: LGPL-3.0-or-later
#include "serial_thermometer.h"

MAUVE_PLUGIN(plugin) {
  using serial_thermometer::Driver;
  plugin.component<serial_thermometer::Shell, Driver, mauve::PeriodicFsm<Driver>>("driver");
}
