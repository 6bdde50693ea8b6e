// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/system/control_trace.h"

#include <utility>
#include <vector>

#include "base/mutex.h"

namespace mauve::exec {

void ControlTrace::add(const TraceRecord& record) {
  const MutexLock lock(mutex_);
  if (records_.size() == kCapacity) {
    records_.pop_front();
    ++lost_;
  }
  records_.push_back(record);
}

std::vector<TraceRecord> ControlTrace::take() {
  const MutexLock lock(mutex_);
  std::vector<TraceRecord> drained;
  if (lost_ != 0) {
    drained.push_back(records_.front());
    drained.back().kind = TraceKind::lost;
    drained.back().name = 0;
    drained.back().a = std::exchange(lost_, 0);
    drained.back().b = 0;
  }
  drained.insert(drained.end(), records_.begin(), records_.end());
  records_.clear();
  return drained;
}

}  // namespace mauve::exec
