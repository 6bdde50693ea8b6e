// SPDX-License-Identifier: LGPL-3.0-or-later
/// Nothing is wrong here. Built several times, with another NUMBER each.
#include "number.h"

namespace {

/// Static data of an inline function: the case in which a plugin is easily pinned in memory.
inline int& calls() {
  static int count = 0;
  return count;
}

class Good final : public zoo::NumberCore {
  int number() override { return NUMBER + 100 * ++calls(); }
};

}  // namespace

MAUVE_PLUGIN(plugin) {
  plugin.core<Good>("number");
  plugin.component<zoo::NumberShell, zoo::NumberFsm>("counter", "number");
  plugin.resource<zoo::NumberShell, Good, zoo::NumberInterface>("register");
  plugin.fsm<zoo::NumberFsm>("pace");
  plugin.type<zoo::Number>();
}
