// SPDX-License-Identifier: LGPL-3.0-or-later
/// Its core cannot be made; it throws a class of its own.
#include <stdexcept>

#include "number.h"

namespace {

struct NoHardware : std::runtime_error {
  NoHardware() : std::runtime_error("no hardware") {}
};

class Throwing final : public zoo::NumberCore {
 public:
  Throwing() { throw NoHardware(); }
  int number() override { return 0; }
};

}  // namespace

MAUVE_PLUGIN(plugin) { plugin.core<Throwing>("number"); }
