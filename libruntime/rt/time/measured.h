// SPDX-License-Identifier: LGPL-3.0-or-later
/// The times of the jobs of one component: written by its thread, read by any thread meanwhile.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "rt/time/histogram.h"

#include <mauve/host/statistics.h>
#include <mauve/time.h>

namespace mauve::rt {

/// Count, sum and maximum of times. One writer.
class Tally {
 public:
  void add(const TimeTotal& more) {
    count_.store(count_.load(std::memory_order_relaxed) + more.count, std::memory_order_relaxed);
    sum_.store(sum_.load(std::memory_order_relaxed) + more.sum.count(), std::memory_order_relaxed);
    if (more.longest.count() > longest_.load(std::memory_order_relaxed)) {
      longest_.store(more.longest.count(), std::memory_order_relaxed);
    }
  }
  void add(std::int64_t value) { add({1, Duration{value}, Duration{value}}); }
  /// While no thread writes.
  void clear() {
    count_.store(0, std::memory_order_relaxed);
    sum_.store(0, std::memory_order_relaxed);
    longest_.store(0, std::memory_order_relaxed);
  }
  [[nodiscard]] TimeTotal look() const {
    return {count_.load(std::memory_order_relaxed), Duration{sum_.load(std::memory_order_relaxed)},
            Duration{longest_.load(std::memory_order_relaxed)}};
  }

 private:
  std::atomic<std::uint64_t> count_{0};
  std::atomic<std::int64_t> sum_{0};
  std::atomic<std::int64_t> longest_{0};
};

/// Of one execution state.
struct StateTimes {
  void add(std::int64_t took, bool preempted_then) {
    if (preempted_then) return preempted.add(took);
    clean.add(took);
  }

  Histogram clean;
  Tally preempted;
};

/// Of all jobs since `since`.
struct JobTimes {
  explicit JobTimes(std::size_t state_count) : states(state_count) {}
  /// While no thread writes.
  void clear();

  std::atomic<Instant> since{0};  ///< start of the first job; 0: none yet
  Histogram lateness;
  Histogram clean;
  Histogram preempted;
  Histogram response;
  Tally lock_waits;
  std::atomic<std::uint64_t> missed{0};
  std::atomic<std::uint64_t> overruns{0};
  std::atomic<std::uint64_t> over_budget{0};
  std::atomic<std::int64_t> over_budget_max{0};  ///< the most processor time of these jobs, in ns
  std::vector<StateTimes> states;                ///< by index
};

/// The times that are counted now. To count anew, [control] shows another block, which it cleared
/// before. The writer goes over to it with its next job, so there is no moment with two writers,
/// and no work for the writer.
class Measured {
 public:
  explicit Measured(std::size_t state_count);

  /// The block in which the writer counts from here on. [rt]
  JobTimes& here() {
    JobTimes* const shown = shown_.load(std::memory_order_acquire);
    if (shown != used_.load(std::memory_order_relaxed)) {
      used_.store(shown, std::memory_order_release);
    }
    return *shown;
  }

  /// Counts anew. Until the writer comes along the shown block is empty. [control]
  void reset();
  [[nodiscard]] const JobTimes& shown() const { return *shown_.load(std::memory_order_acquire); }
  [[nodiscard]] std::size_t state_count() const { return blocks_.front()->states.size(); }

 private:
  std::array<std::unique_ptr<JobTimes>, 2> blocks_;  // the second is made by the first reset
  std::atomic<JobTimes*> shown_;
  std::atomic<JobTimes*> used_{nullptr};
};

}  // namespace mauve::rt
