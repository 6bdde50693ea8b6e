// SPDX-License-Identifier: LGPL-3.0-or-later
#include "wheel.h"

MAUVE_PLUGIN(plugin) {
  plugin.core<wheel::V1>("v1");
  plugin.core<wheel::V2>("v2");
  plugin.core<wheel::V3>("v3");
  plugin.component<wheel::Shell, mauve::PeriodicFsm<wheel::Counter>>("counter", "v1");
}
