// SPDX-License-Identifier: LGPL-3.0-or-later
/// Code that would run inside dlopen, where nobody can catch it.
#include <stdexcept>

#include "number.h"

namespace {

int never() { throw std::runtime_error("nobody catches this"); }

const int kValue = never();

class Static final : public zoo::NumberCore {
  int number() override { return kValue; }
};

}  // namespace

MAUVE_PLUGIN(plugin) { plugin.core<Static>("number"); }
