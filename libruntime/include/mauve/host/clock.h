// SPDX-License-Identifier: LGPL-3.0-or-later
/// Clocks: the machine's monotonic one, and one that a test moves by hand.
#pragma once

#include <atomic>

#include <mauve/time.h>

namespace mauve {

/// Where the runtime reads the time. [any]
class Clock {
 public:
  virtual ~Clock() = default;
  [[nodiscard]] virtual Instant now() const = 0;  ///< never goes backwards
};

/// CLOCK_MONOTONIC.
class MonotonicClock final : public Clock {
 public:
  [[nodiscard]] Instant now() const override;  ///< see Clock
};

/// Stands still until it is moved. For tests and simulated runs.
class ManualClock final : public Clock {
 public:
  explicit ManualClock(Instant start = 0) : now_(start) {}  ///< stands at `start`
  /// See Clock.
  [[nodiscard]] Instant now() const override { return now_.load(std::memory_order_relaxed); }
  void set(Instant now) { now_.store(now, std::memory_order_relaxed); }  ///< moves it there
  void advance(Duration by) { set(now() + by.count()); }                 ///< moves it on

 private:
  std::atomic<Instant> now_;
};

}  // namespace mauve
