// SPDX-License-Identifier: LGPL-3.0-or-later
/// Mutex with priority inheritance and a bounded wait; std::mutex has neither.
#pragma once

#include <pthread.h>

#include "base/mutex.h"

#include <mauve/time.h>

namespace mauve::rt {

class MAUVE_THREAD_ATTRIBUTE(capability("mutex")) PiMutex {
 public:
  PiMutex();
  ~PiMutex();
  PiMutex(const PiMutex&) = delete;
  PiMutex& operator=(const PiMutex&) = delete;

  /// About 10 ns when no thread holds it; false when one does. [rt]
  [[nodiscard]] bool try_lock() MAUVE_THREAD_ATTRIBUTE(try_acquire_capability(true));
  /// False when `deadline` (monotonic) passed first. The holder runs at the waiter's priority. [rt]
  [[nodiscard]] bool lock_until(Instant deadline)
      MAUVE_THREAD_ATTRIBUTE(try_acquire_capability(true));
  /// Waits as long as it takes; for holders that are known to be quick.
  void lock() MAUVE_THREAD_ATTRIBUTE(acquire_capability());
  void unlock() MAUVE_THREAD_ATTRIBUTE(release_capability());

 private:
  pthread_mutex_t mutex_;
};

/// Holds such a mutex until the end of its scope.
class MAUVE_THREAD_ATTRIBUTE(scoped_lockable) PiMutexLock {
 public:
  explicit PiMutexLock(PiMutex& mutex) MAUVE_THREAD_ATTRIBUTE(acquire_capability(mutex))
      : mutex_(mutex) {
    mutex_.lock();
  }
  ~PiMutexLock() MAUVE_THREAD_ATTRIBUTE(release_capability()) { mutex_.unlock(); }
  PiMutexLock(const PiMutexLock&) = delete;
  PiMutexLock& operator=(const PiMutexLock&) = delete;

 private:
  PiMutex& mutex_;
};

}  // namespace mauve::rt
