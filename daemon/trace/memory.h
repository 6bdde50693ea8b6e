// SPDX-License-Identifier: LGPL-3.0-or-later
/// The last records of all threads, as many as there is room for.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "mauve/trace.h"

namespace mauve::daemon {

/// The records of a span of time, sorted by time; the records of each thread stay in its order.
struct Recording {
  TracedSystem about;
  std::string why;
  Instant from = 0;  ///< since T0
  Instant to = 0;
  std::int64_t lost = 0;  ///< records that were not collected in time
  bool probed = false;    ///< all the time, to find delays by the host or by foreign work
  std::vector<TraceRecord> records;
};
using RecordingPtr = std::shared_ptr<const Recording>;

/// Takes its memory with the first record, and never more. One thread at a time.
class TraceMemory {
 public:
  static constexpr std::size_t kCapacity = 131'072;  ///< 5 MB: ten seconds of a whole robot

  explicit TraceMemory(std::size_t capacity = kCapacity) : capacity_(capacity) {}

  void add(const TraceRecord& record) {
    if (records_.empty()) records_.resize(capacity_);
    records_[total_ % capacity_] = record;
    ++total_;
  }
  [[nodiscard]] std::size_t size() const { return std::min(total_, capacity_); }
  [[nodiscard]] std::size_t bytes() const { return records_.size() * sizeof(TraceRecord); }

  /// All that is not older than `from`, sorted; `about` and `why` are left to the caller.
  [[nodiscard]] Recording since(Instant from) const;

 private:
  const std::size_t capacity_;
  std::vector<TraceRecord> records_;
  std::size_t total_ = 0;
};

}  // namespace mauve::daemon
