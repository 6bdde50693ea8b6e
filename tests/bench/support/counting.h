// SPDX-License-Identifier: LGPL-3.0-or-later
/// Components whose cores count, for benchmarks that change all of them at once.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "bench/support/machine.h"

#include <mauve/host/architecture.h>
#include <mauve/host/change.h>

namespace bench {

struct Count {
  double value = 0;
};
/// The contract.
struct CountingWork : mauve::Core<mauve::EmptyShell> {
  using Contract = CountingWork;
  static constexpr const char* contract = "work/core/1";
  virtual void update() = 0;
};
/// Hands its count over to another one.
template <int Step>
struct Counting final : CountingWork {
  mauve::State<Count> state{*this};
  void update() override { state->value += Step; }
};

/// "component0" and so on, one after the other over the CPUs.
struct CountingMany : mauve::Architecture {
  using Component =
      mauve::Component<mauve::EmptyShell, Counting<1>, mauve::PeriodicFsm<CountingWork>>;

  CountingMany(std::size_t count, Duration period) {
    const std::vector<int> cpus = mauve::rt::usable_cpus();
    for (std::size_t i = 0; i < count; ++i) {
      auto& made = *components.emplace_back(
          std::make_unique<Component>(*this, "component" + std::to_string(i)));
      made.fsm().period = period;
      made.task().priority = 50;
      made.task().budget = std::chrono::microseconds(10);
      made.task().cpus = {cpus[i % cpus.size()]};
    }
  }
  /// All of them get such a core.
  template <int Step>
  [[nodiscard]] mauve::Change to() const {
    mauve::Change change;
    for (const auto& component : components) {
      mauve::Edit edit;
      edit.member = component->name();
      edit.core = mauve::CoreType::of<Counting<Step>>("counting" + std::to_string(Step));
      change.edits.push_back(std::move(edit));
    }
    return change;
  }

  std::vector<std::unique_ptr<Component>> components;
};

}  // namespace bench
