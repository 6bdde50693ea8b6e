// SPDX-License-Identifier: LGPL-3.0-or-later
/// The lock under which a preparation, user code included, may rely on the model.
#pragma once

#include "base/mutex.h"
#include "model/job/abandonable_thread.h"

namespace mauve::exec {

/// A mutex that a thread loses when it is abandoned.
class ModelLock {
 public:
  /// Holds it for a scope, and is inside (abandonable_thread.h) meanwhile.
  class Hold {
   public:
    /// Waits for it. False: the calling thread was abandoned.
    explicit Hold(ModelLock& lock) : lock_(lock), held_(lock.take(true)) {}
    /// Does not wait. False: another thread holds it.
    Hold(ModelLock& lock, std::try_to_lock_t /*does not wait*/)
        : lock_(lock), held_(lock.take(false)) {}
    ~Hold() {
      if (held_) lock_.unlock();
    }
    Hold(const Hold&) = delete;
    Hold& operator=(const Hold&) = delete;
    explicit operator bool() const { return held_ && inside_; }

   private:
    ModelLock& lock_;
    const bool held_;
    const Inside inside_;
  };

 private:
  [[nodiscard]] bool take(bool waits);
  void unlock();

  Mutex mutex_;
  ConditionVariable freed_;
  bool held_ MAUVE_GUARDED_BY(mutex_) = false;
  const AbandonableThread* owner_ MAUVE_GUARDED_BY(mutex_) =
      nullptr;  // null: a thread that is never abandoned
};

}  // namespace mauve::exec
