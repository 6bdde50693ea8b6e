// SPDX-License-Identifier: LGPL-3.0-or-later
/// How late threads wake up on this machine: every release of a component begins with that.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "doctor/finding.h"
#include "render/render.h"

namespace mauve::ctl::doctor {

inline constexpr int kWakePriority = 94;  ///< components have at most 90, the guard 95

/// The wake-ups of one thread, 1000 a second at absolute instants.
struct Wakes {
  int cpu = 0;
  bool fifo = false;                       ///< false: an ordinary thread, for want of rights
  std::vector<std::int64_t> late_ns = {};  ///< after the instant asked for

  /// The lateness that so many percent do not exceed; 100: the longest.
  [[nodiscard]] std::int64_t percentile(double percent) const;
};

/// Runs a thread on each CPU for a time, above all components and below the guard. CPUs that
/// threads may not be bound to are left out.
[[nodiscard]] std::vector<Wakes> measure_wakes(std::chrono::nanoseconds time,
                                               const std::vector<int>& cpus);

[[nodiscard]] Finding judge_wakes(const std::vector<Wakes>& all);

/// A row a CPU, then a histogram of all.
[[nodiscard]] std::string render_wakes(const std::vector<Wakes>& all, Look look);

[[nodiscard]] Json wakes_json(const std::vector<Wakes>& all);

}  // namespace mauve::ctl::doctor
