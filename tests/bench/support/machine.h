// SPDX-License-Identifier: LGPL-3.0-or-later
/// Machine: what a figure was measured on, and when something foreign disturbed it.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <deque>
#include <string>

#include "rt/thread/thread.h"

#include <mauve/time.h>

namespace bench {

using mauve::Duration;
using mauve::Instant;

/// CPU, kernel, clock source, governor, load, and SCHED_FIFO threads that are not ours.
[[nodiscard]] std::string describe_machine();

/// Monotonic clock, read directly.
[[nodiscard]] Instant now();

/// Ties the ticks of the processor to the clock, as the collector of traces does twice a second.
/// Without it, the times of ticks come from the system. The call takes a quarter of a second, and
/// its effect lasts for ten.
void tie_ticks();

/// Processor time of this process so far, all its threads and what the kernel did for them.
[[nodiscard]] Instant processor_time();

/// A number of kB from a file of proc(5).
[[nodiscard]] double kilobytes(const char* file, const std::string& key);

/// The highest priority this process may use up to `wanted`: that, or 0 (ordinary threads).
[[nodiscard]] int fifo_or_none(int wanted);

/// The calling thread on one CPU with SCHED_FIFO for a scope, where permitted. At most tens of
/// milliseconds at a time: nothing else runs there.
class OnCpu {
 public:
  OnCpu(int cpu, int priority);
  ~OnCpu();
  OnCpu(const OnCpu&) = delete;
  OnCpu& operator=(const OnCpu&) = delete;
};

/// A SCHED_FIFO 99 thread on each CPU that wakes twice a millisecond, or as said. When it is itself
/// late, the host or foreign real-time threads were in the way: samples of that time are set apart.
class Probe {
 public:
  static constexpr Duration kPeriod{500'000};
  static constexpr Duration kTolerance{200'000};

  /// Its wake-ups are at `phase` plus multiples of the period.
  explicit Probe(Instant phase, Duration period = kPeriod);
  ~Probe();

  /// Was this CPU disturbed around the instant? Ask when two periods have passed.
  [[nodiscard]] bool disturbed(int cpu, Instant instant) const {
    return disturbed(cpu, instant, instant);
  }
  /// Or at some time between these?
  [[nodiscard]] bool disturbed(int cpu, Instant from, Instant to) const;
  /// Windows seen so far, on all CPUs.
  [[nodiscard]] std::size_t windows() const;

 private:
  struct Window {
    Instant from;
    Instant to;
  };
  struct Watch {
    int cpu = 0;
    std::array<Window, 4096> windows{};
    std::atomic<std::size_t> count{0};
    mauve::rt::Thread thread;
  };
  void run(Watch& watch, Instant due);

  Duration period_;
  std::atomic<bool> quit_{false};
  std::deque<Watch> watches_;
};

}  // namespace bench
