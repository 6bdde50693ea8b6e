// SPDX-License-Identifier: LGPL-3.0-or-later
#include "tracker.h"

MAUVE_PLUGIN(plugin) {
  plugin.type<tracker::Motion>();
  plugin.component<tracker::Shell, tracker::Filter, mauve::PeriodicFsm<tracker::Filter>>("filter");
}
