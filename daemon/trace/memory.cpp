// SPDX-License-Identifier: LGPL-3.0-or-later
#include "trace/memory.h"

#include <algorithm>

namespace mauve::daemon {

Recording TraceMemory::since(Instant from) const {
  Recording recording;
  recording.from = from;
  recording.to = from;
  for (std::size_t i = total_ - size(); i < total_; ++i) {
    const TraceRecord& record = records_[i % capacity_];
    if (record.time < from) continue;
    recording.records.push_back(record);
    if (record.kind == TraceKind::lost) recording.lost += record.a;
  }
  std::stable_sort(recording.records.begin(), recording.records.end(),
                   [](const TraceRecord& a, const TraceRecord& b) { return a.time < b.time; });
  if (!recording.records.empty()) {
    recording.to = recording.records.back().time;
    if (size() == capacity_) recording.from = recording.records.front().time;
  }
  return recording;
}

}  // namespace mauve::daemon
