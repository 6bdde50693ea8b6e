// SPDX-License-Identifier: LGPL-3.0-or-later
/// The records of [control] and [factory] in a trace.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include <mauve/trace.h>

#include "base/mutex.h"

namespace mauve::exec {

/// The records of [control] and [factory]: behind a lock that no real-time thread takes.
class ControlTrace {
 public:
  static constexpr std::size_t kCapacity = 4096;

  void add(const TraceRecord& record);
  /// In order; the number of records dropped since the last time comes first, as `lost`.
  [[nodiscard]] std::vector<TraceRecord> take();

 private:
  Mutex mutex_;
  std::deque<TraceRecord> records_ MAUVE_GUARDED_BY(mutex_);
  std::int64_t lost_ MAUVE_GUARDED_BY(mutex_) = 0;
};

}  // namespace mauve::exec
