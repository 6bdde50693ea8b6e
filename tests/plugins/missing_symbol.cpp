// SPDX-License-Identifier: LGPL-3.0-or-later
/// Calls a function that nobody defines; linked in spite of that.
#include <mauve/plugin.h>

namespace zoo {
int nobody_wrote_me(double value);
}

MAUVE_PLUGIN(plugin) {
  if (zoo::nobody_wrote_me(1.0) != 0) plugin.cores.clear();
}
