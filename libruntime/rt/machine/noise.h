// SPDX-License-Identifier: LGPL-3.0-or-later
/// Noise: the lateness of probes while components run. It measures for how long the machine held up
/// a CPU, so that no core is blamed for that time. It also measures how late threads wake up, so
/// that an assumption about the machine can be compared with it.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <memory>
#include <vector>

#include "rt/machine/probe.h"
#include "rt/time/histogram.h"

#include <mauve/host/machine.h>

namespace mauve::rt {

/// The report of one probe. Written by its thread, read by any thread meanwhile.
class NoiseOfCpu {
 public:
  /// A probe that ran later than this, and than twice the assumed time, was held up.
  static constexpr Duration kLate = 200us;
  /// A block of the distribution; the one before is kept beside it.
  static constexpr Duration kBlock = 60s;

  explicit NoiseOfCpu(Duration assumed) : assumed_(assumed), late_(std::max(kLate, 2 * assumed)) {}
  /// [rt]
  void add(Instant due, Instant ran);
  /// How late the probe ran when it was held up last, if that was at this instant or later; else
  /// zero. [any]
  [[nodiscard]] Duration held_up_since(Instant instant) const {
    const bool since = late_at_.load(std::memory_order_acquire) >= instant;
    return Duration{since ? late_by_.load(std::memory_order_relaxed) : 0};
  }
  /// When the probe ran last; 0: it did not run yet. [any]
  [[nodiscard]] Instant ran_at() const { return ran_at_.load(std::memory_order_relaxed); }
  [[nodiscard]] WakeNoise look(Instant now) const;

 private:
  struct Block {
    std::atomic<Instant> since{0};  ///< 0: empty
    std::atomic<std::uint64_t> beyond{0};
    Histogram late;
  };
  void turn_over(Instant now);

  const Duration assumed_;
  const Duration late_;
  std::atomic<Instant> late_at_{0};
  std::atomic<std::int64_t> late_by_{0};
  std::atomic<Instant> ran_at_{0};
  std::atomic<std::int64_t> worst_{0};
  std::atomic<Instant> worst_at_{0};
  std::array<Block, 2> blocks_;
  std::atomic<std::size_t> current_{0};
};

/// The probes of all CPUs that real-time components use.
class Noise {
 public:
  /// How often each probe wakes up: it takes some 0.1 % of its CPU.
  static constexpr Duration kPeriod = 4ms;

  /// `assumed`: wake-ups later than this are counted, see WakeNoise::beyond.
  explicit Noise(Duration assumed);
  ~Noise();
  Noise(const Noise&) = delete;
  Noise& operator=(const Noise&) = delete;

  /// Starts the probes of these CPUs that do not run yet; none given: of all usable CPUs. Without
  /// the rights for a probe the CPU has none, and nothing is known of it. One caller at a time.
  void watch(const std::vector<int>& cpus);
  /// Ends all probes; their reports stay. One caller at a time.
  void stop();

  /// For how long the probe of the caller's CPU was held up at this instant or later; zero: it was
  /// not, or there is no probe. Some loads; no lock, no wait. [rt]
  [[nodiscard]] Duration held_up_since(Instant instant) const;
  /// Does a probe run on the CPU of the caller? [rt]
  [[nodiscard]] bool is_known() const;
  /// The probe of one of these CPUs should have run and did not: the CPU stands still right now.
  /// [any]
  [[nodiscard]] bool stands_still(const std::vector<int>& cpus, Instant now) const;
  /// A row for each CPU that has a probe. [any]
  [[nodiscard]] std::vector<WakeNoise> look(Instant now) const;

 private:
  [[nodiscard]] const NoiseOfCpu* find(int cpu) const;

  const Duration assumed_;
  /// By CPU; null: no probe. Entries appear and stay.
  std::vector<std::atomic<NoiseOfCpu*>> cpus_;
  std::vector<std::unique_ptr<NoiseOfCpu>> owned_;
  std::vector<std::unique_ptr<Probe>> probes_;
};

}  // namespace mauve::rt
