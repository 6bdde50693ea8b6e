// SPDX-License-Identifier: LGPL-3.0-or-later
#include "serial_heater.h"

MAUVE_PLUGIN(plugin) {
  using serial_heater::Driver;
  plugin.component<serial_heater::Shell, Driver, mauve::PeriodicFsm<Driver>>("driver");
}
