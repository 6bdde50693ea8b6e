// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/plugin.h>

#include "drive.h"
#include "supervisor.h"

MAUVE_PLUGIN(plugin) {
  using mauve::PeriodicFsm;
  plugin.component<energy::SupervisorShell, energy::Supervisor, PeriodicFsm<energy::Supervisor>>(
      "supervisor");
  plugin.component<energy::DriveShell, energy::Drive, PeriodicFsm<energy::Drive>>("drive");
}
