// SPDX-License-Identifier: LGPL-3.0-or-later
/// Registers one name twice.
#include "number.h"

namespace {

class Twice final : public zoo::NumberCore {
  int number() override { return 2; }
};

}  // namespace

MAUVE_PLUGIN(plugin) {
  plugin.core<Twice>("number");
  plugin.core<Twice>("number");
}
