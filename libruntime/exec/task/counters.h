// SPDX-License-Identifier: LGPL-3.0-or-later
/// Counters of a component, and the operations with which their writer changes them.
#pragma once

#include <atomic>
#include <cstdint>

#include <mauve/host/report.h>

namespace mauve::exec {

/// Any thread reads them. The owner of the task writes them: its thread, or [guard] once that is
/// abandoned. [control] writes them before the first release. Times are in nanoseconds.
struct Counters {
  std::atomic<std::uint64_t> releases{0};
  std::atomic<std::uint64_t> missed{0};
  std::atomic<std::uint64_t> overruns{0};
  std::atomic<std::uint64_t> over_budget{0};
  std::atomic<std::uint64_t> over_present_budget{0};  ///< of these: with this core and budget
  std::atomic<std::uint64_t> faults{0};
  std::atomic<std::uint64_t> restored{0};  ///< how often [guard] restored its scheduling
  std::atomic<std::int64_t> lateness_last{0};
  std::atomic<std::int64_t> lateness_max{0};
  std::atomic<std::int64_t> elapsed_last{0};
  std::atomic<std::int64_t> elapsed_max{0};   ///< preemption by others included
  std::atomic<std::int64_t> used_max{0};      ///< processor time of a job; 0: none was measured
  std::atomic<std::int64_t> next_release{0};  ///< since T0
  std::atomic<std::uint32_t> fsm_state{0};
  std::atomic<ComponentState> state{ComponentState::stopped};
  std::atomic<bool> without_thread{false};  ///< [control] writes its safe values, and clears this
  std::atomic<bool> suspected{false};  ///< its last jobs exceeded their budget, without a verdict
};

/// A counter has one writer at a time: a load and a store are enough.
template <typename T>
void add(std::atomic<T>& counter, T amount) {
  counter.store(counter.load(std::memory_order_relaxed) + amount, std::memory_order_relaxed);
}
template <typename T>
void raise(std::atomic<T>& maximum, T value) {
  if (value > maximum.load(std::memory_order_relaxed)) {
    maximum.store(value, std::memory_order_relaxed);
  }
}

}  // namespace mauve::exec
