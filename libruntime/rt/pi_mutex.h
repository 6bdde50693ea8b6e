// SPDX-License-Identifier: LGPL-3.0-or-later
/// Mutex with priority inheritance and a bounded wait; std::mutex has neither.
#pragma once

#include <pthread.h>

#include <mauve/time.h>

namespace mauve::rt {

class PiMutex {
 public:
  PiMutex();
  ~PiMutex();
  PiMutex(const PiMutex&) = delete;
  PiMutex& operator=(const PiMutex&) = delete;

  /// About 10 ns when nobody holds it; false when somebody does. [rt]
  [[nodiscard]] bool try_lock();
  /// False when `deadline` (monotonic) passed first. The holder runs at the waiter's priority. [rt]
  [[nodiscard]] bool lock_until(Instant deadline);
  /// Waits as long as it takes; for holders that are known to be quick.
  void lock();
  void unlock();

 private:
  pthread_mutex_t mutex_;
};

}  // namespace mauve::rt
