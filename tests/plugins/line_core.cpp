// SPDX-License-Identifier: LGPL-3.0-or-later
/// Cores for the component of line.h, from a plugin of their own.
#include "line.h"

namespace {

class Other final : public line::Core {
  mauve::Stateless stateless{*this};
  void update() override { shell().out.write(LINE_BUILD); }
};

class Counting final : public line::Core {
  mauve::State<line::Sum> state{*this};
  mauve::Observable<std::int64_t> count{*this, "count"};
  void update() override {
    state->last = 0.5;
    count = ++state->count;
    shell().out.write(LINE_BUILD);
  }
};

}  // namespace

MAUVE_PLUGIN(plugin) {
  plugin.core<Other>("other");
  plugin.core<Counting>("counting");
}
