// SPDX-License-Identifier: LGPL-3.0-or-later
#include "blink.h"

#include <mauve-plugins/drivers/recording/playback.h>

MAUVE_PLUGIN(plugin) {
  plugin.type<blink::Lit>();
  plugin.component<blink::Shell, blink::Core, mauve::PeriodicFsm<blink::Core>>("blink");
  drivers::declare_playback_of<blink::Lit>(plugin, "playback_lit");
}
