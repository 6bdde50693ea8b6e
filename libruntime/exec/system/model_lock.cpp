// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/system/model_lock.h"

#include "base/mutex.h"

namespace mauve::exec {

bool ModelLock::take(bool waits) {
  MutexLock lock(mutex_);
  const auto free = [this]() MAUVE_REQUIRES(mutex_) {
    return !held_ || (owner_ != nullptr && owner_->abandoned());
  };
  if (waits) {
    freed_.wait(lock, free);
  } else if (!free()) {
    return false;
  }
  held_ = true;
  owner_ = AbandonableThread::here();
  return true;
}

void ModelLock::unlock() {
  {
    const MutexLock lock(mutex_);
    if (owner_ != AbandonableThread::here()) return;  // it was abandoned, and another one has it
    held_ = false;
    owner_ = nullptr;
  }
  freed_.notify_one();
}

}  // namespace mauve::exec
