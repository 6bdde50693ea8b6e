// SPDX-License-Identifier: LGPL-3.0-or-later
/// Registers a name in somebody else's plugin.
#include "number.h"

namespace {

class Stranger final : public zoo::NumberCore {
  int number() override { return 3; }
};

}  // namespace

MAUVE_PLUGIN(plugin) { plugin.core<Stranger>("good/number"); }
