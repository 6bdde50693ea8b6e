// SPDX-License-Identifier: LGPL-3.0-or-later
/// How late jobs began, and which releases were missed, what was disturbed apart.
#pragma once

#include <cstdint>
#include <vector>

#include "bench/support/machine.h"
#include "bench/support/raw.h"

namespace bench {

struct Lateness {
  std::vector<double> good;  // us
  std::size_t apart = 0;
  std::int64_t missed = 0;        // releases without a start
  std::int64_t missed_apart = 0;  // more of them, while the machine was disturbed
};

inline constexpr std::size_t kWarmUp = 100;

/// How far each start is behind its release, all after the first hundred, into `result`.
inline void add_lateness(Lateness& result, const Instants& starts, Instant first, Duration period,
                         int cpu, const Probe& probe) {
  for (std::size_t i = kWarmUp; i < starts.size(); ++i) {
    const std::int64_t skipped =
        (starts[i] - first) / period.count() - (starts[i - 1] - first) / period.count() - 1;
    const bool disturbed = probe.disturbed(cpu, starts[i]) || probe.disturbed(cpu, starts[i - 1]);
    (disturbed ? result.missed_apart : result.missed) += skipped;
    if (probe.disturbed(cpu, starts[i])) {
      ++result.apart;
    } else {
      result.good.push_back(static_cast<double>((starts[i] - first) % period.count()) / 1e3);
    }
  }
}

}  // namespace bench
