// SPDX-License-Identifier: LGPL-3.0-or-later
/// A plugin without content; its faults come from the linker.
#include <mauve/plugin.h>

MAUVE_PLUGIN(plugin) { plugin.cores.clear(); }
