// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/time/measured.h"

#include <algorithm>
#include <cmath>

namespace mauve::rt {

void JobTimes::clear() {
  since.store(0, std::memory_order_relaxed);
  for (Histogram* times : {&lateness, &clean, &preempted, &response}) times->clear();
  lock_waits.clear();
  for (auto* counter : {&missed, &overruns, &over_budget}) {
    counter->store(0, std::memory_order_relaxed);
  }
  over_budget_max.store(0, std::memory_order_relaxed);
  for (StateTimes& state : states) {
    state.clean.clear();
    state.preempted.clear();
  }
}

Measured::Measured(std::size_t state_count)
    : blocks_{std::make_unique<JobTimes>(state_count), nullptr}, shown_(blocks_.front().get()) {}

void Measured::reset() {
  const JobTimes* const shown = shown_.load(std::memory_order_relaxed);
  // The writer has not come along yet, so the shown block is empty, and the other block is in use.
  if (used_.load(std::memory_order_acquire) != shown) return;
  auto& other = blocks_.at(blocks_.front().get() == shown ? 1 : 0);
  if (other == nullptr) {
    other = std::make_unique<JobTimes>(state_count());
  } else {
    other->clear();
  }
  shown_.store(other.get(), std::memory_order_release);
}

}  // namespace mauve::rt

namespace mauve {

Duration Distribution::mean() const {
  return count == 0 ? Duration{0} : sum / static_cast<std::int64_t>(count);
}

/// Ranks are those of the buckets: the count may be some samples further.
Duration Distribution::percentile(double percent) const {
  std::uint64_t all = 0;
  for (const Bucket& bucket : buckets) all += bucket.count;
  const double share = std::clamp(percent, 0.0, 100.0) / 100;
  const auto rank = static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(all)));
  std::uint64_t passed = 0;
  for (const Bucket& bucket : buckets) {
    passed += bucket.count;
    if (passed < rank || rank == all) continue;
    return std::clamp((bucket.from + bucket.to) / 2, min, max);
  }
  return max;
}

}  // namespace mauve
