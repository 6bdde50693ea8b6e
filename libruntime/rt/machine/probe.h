// SPDX-License-Identifier: LGPL-3.0-or-later
/// Probe: a thread above all others on one CPU that wakes up at fixed instants and reports how late
/// it ran. When it ran late, the host or the kernel held up every thread of that CPU.
#pragma once

#include <atomic>
#include <functional>

#include "rt/thread/thread.h"

namespace mauve::rt {

class Probe {
 public:
  /// `report` gets the instant asked for and the instant at which the probe ran; it is called on
  /// the probe's thread and must neither wait nor allocate. [rt]
  using Report = std::function<void(Instant due, Instant ran)>;

  Probe(int cpu, Duration period, Report report);
  /// Ends the thread; waits at most one period.
  ~Probe();
  Probe(const Probe&) = delete;
  Probe& operator=(const Probe&) = delete;

  /// Refused without the right to use SCHED_FIFO at the highest priority.
  Status start();

 private:
  void run();

  const int cpu_;
  const Duration period_;
  const Report report_;
  std::atomic<bool> quit_{false};
  Thread thread_;
};

}  // namespace mauve::rt
