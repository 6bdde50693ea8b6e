// SPDX-License-Identifier: LGPL-3.0-or-later
/// Its component type names a default core of another contract.
#include "number.h"

namespace {

class OtherCore final : public mauve::Core<zoo::NumberShell> {};

}  // namespace

MAUVE_PLUGIN(plugin) {
  plugin.core<OtherCore>("other");
  plugin.component<zoo::NumberShell, zoo::NumberFsm>("counter", "other");
}
