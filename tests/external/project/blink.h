// SPDX-License-Identifier: LGPL-3.0-or-later
/// A lamp that goes on and off: the smallest component with a port, a property and a state.
#pragma once

#include <mauve/plugin.h>

namespace blink {

struct Lit {
  bool on = false;
};

}  // namespace blink

template <>
struct mauve::Described<blink::Lit> {
  static constexpr std::string_view name = "blink_lit/1";
  static constexpr auto fields() { return std::tuple{field("on", &blink::Lit::on)}; }
};

namespace blink {

struct Shell : mauve::Shell {
  mauve::WritePort<double> lamp{*this, "lamp", mauve::Safe{0.0}};
};

class Core final : public mauve::Core<Shell> {
 public:
  mauve::Property<double> brightness{*this, "brightness", 0.5, "when on", {.min = 0.0, .max = 1.0}};
  mauve::State<Lit> state{*this};
  mauve::Observable<int> blinks{*this, "blinks", 0, "times the lamp went on"};

  void update() {
    state->on = !state->on;
    if (state->on) ++blinks;
    shell().lamp.write(state->on ? brightness.get() : 0.0);
  }
};

}  // namespace blink
