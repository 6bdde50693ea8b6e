// SPDX-License-Identifier: LGPL-3.0-or-later
/// A bare include brings a static initialiser.
#include <iostream>

#include "number.h"

namespace {

class Printing final : public zoo::NumberCore {
  int number() override { return std::cout.good() ? 1 : 0; }
};

}  // namespace

MAUVE_PLUGIN(plugin) { plugin.core<Printing>("number"); }
