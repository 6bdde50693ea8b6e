// SPDX-License-Identifier: LGPL-3.0-or-later
/// CoreFailure: the failure of a component's core, while no job runs because of it. The failure is
/// forgotten when another core takes over, when a change goes on probation or is rolled back, and
/// when the component starts or parks.
#pragma once

#include <atomic>
#include <optional>

#include "exec/update/fault_record.h"

#include <mauve/time.h>

namespace mauve::exec {

class CoreFailure {
 public:
  // --- [rt] the thread of the task, or [guard] once that is abandoned ---------------------------
  /// The core has failed; no job runs meanwhile.
  [[nodiscard]] explicit operator bool() const { return cause_.has_value(); }
  [[nodiscard]] Cause cause() const { return *cause_; }
  void fail(Cause cause, Instant at) {
    cause_ = cause;
    at_.store(at, std::memory_order_release);
  }
  void forget() {
    if (!cause_) return;
    cause_.reset();
    at_.store(0, std::memory_order_release);
  }

  // --- [control] --------------------------------------------------------------------------------
  /// No core will take over from the one that failed at this instant. The instant names the
  /// failure: a later one is not concerned.
  void declare_hopeless(Instant at) { hopeless_.store(at, std::memory_order_release); }

  // --- [any] ------------------------------------------------------------------------------------
  /// When the core failed; 0: there is no failure.
  [[nodiscard]] Instant at() const { return at_.load(std::memory_order_acquire); }
  [[nodiscard]] bool is_hopeless() const {
    const Instant failed_at = at();
    return failed_at != 0 && hopeless_.load(std::memory_order_acquire) == failed_at;
  }

 private:
  std::optional<Cause> cause_;
  std::atomic<Instant> at_{0};
  std::atomic<Instant> hopeless_{0};
};

}  // namespace mauve::exec
