// SPDX-License-Identifier: LGPL-3.0-or-later
/// A thread-local variable: its first use on a real-time thread would allocate.
#include "number.h"

namespace {

thread_local int calls = 0;

class Counting final : public zoo::NumberCore {
  int number() override { return ++calls; }
};

}  // namespace

MAUVE_PLUGIN(plugin) { plugin.core<Counting>("number"); }
