// SPDX-License-Identifier: LGPL-3.0-or-later
/// Exports more than mauve_plugin: built without the version script.
#include <mauve/plugin.h>

extern "C" MAUVE_EXPORT int a_second_symbol() { return 2; }

MAUVE_PLUGIN(plugin) { plugin.cores.clear(); }
