// SPDX-License-Identifier: LGPL-3.0-or-later
/// An absolute address among the instructions, which the linker would have to write there.
#include <mauve/plugin.h>

__asm__(".text\n.quad mauve_plugin\n");

MAUVE_PLUGIN(plugin) { plugin.cores.clear(); }
