// SPDX-License-Identifier: LGPL-3.0-or-later
/// Component kind "wheel/counter" and three cores that replace one another. In a project there is
/// one core, which grows from release to release; here its three releases stand side by side.
#pragma once

#include <mauve/plugin.h>

#include "states.h"

namespace wheel {

struct Shell : mauve::Shell {
  /// Ticks since the job before. Without an encoder each job counts one tick.
  mauve::ReadPort<int> ticks{*this, "ticks", 1, mauve::Need::optional};
};

/// The contract: the state machine calls it, and cores of one contract replace one another.
class Counter : public mauve::Core<Shell> {
 public:
  using Contract = Counter;
  static constexpr const char* contract = "wheel/counter/1";

  mauve::Observable<double> shown{*this, "shown", 0.0, "ticks; of V3 metres"};
  virtual void update() = 0;  // [rt] every 10 ms
};

class V1 final : public Counter {
  mauve::State<CountV1> state{*this};

  void update() override { shown = static_cast<double>(state->ticks += shell().ticks.read()); }
};

/// Takes over the state of V1.
class V2 final : public Counter {
  mauve::State<CountV2> state{*this};
  /// [rt] It runs once, on the thread of the component, between two jobs. It must not fail.
  mauve::Converts<CountV1, CountV2> from_v1{
      state, [](const CountV1& old, CountV2& now) noexcept { now.ticks = old.ticks; }};

  void update() override {
    const int ticks = shell().ticks.read();
    state->speed = ticks / mauve::to_seconds(mauve::time_step());
    shown = static_cast<double>(state->ticks += ticks);
  }
};

/// Takes over the state of V2, and of no other revision.
class V3 final : public Counter {
  mauve::State<CountV3> state{*this};
  mauve::Converts<CountV2, CountV3> from_v2{state, [](const CountV2& old, CountV3& now) noexcept {
                                              now.distance = static_cast<double>(old.ticks) * kTick;
                                              now.speed = old.speed * kTick;
                                            }};

  void update() override {
    const double moved = shell().ticks.read() * kTick;
    state->speed = moved / mauve::to_seconds(mauve::time_step());
    shown = state->distance += moved;
  }
};

}  // namespace wheel
