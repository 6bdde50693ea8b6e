// SPDX-License-Identifier: LGPL-3.0-or-later
/// Mutex, MutexLock and ConditionVariable: std::mutex and its companions, with annotations that
/// clang checks at compile time (-Wthread-safety). A thread uses data that a mutex guards only
/// while it holds the mutex. Not for real-time threads, which use rt::PiMutex, since a wait here
/// has no bound.
///
/// The holder of a mutex inherits the priority of those who wait for it: [stop], [safe] and [link]
/// share some with ordinary threads, which other programs may keep from the processor.
///
/// See "Thread Safety Analysis" in the manual of clang, where the names of the macros come from.
#pragma once

#include <pthread.h>

#include <chrono>
#include <condition_variable>
#include <mutex>

#if defined(__clang__)
#define MAUVE_THREAD_ATTRIBUTE(x) __attribute__((x))
#else
#define MAUVE_THREAD_ATTRIBUTE(x)
#endif

/// Of a member: it is used only while this mutex is held.
#define MAUVE_GUARDED_BY(mutex) MAUVE_THREAD_ATTRIBUTE(guarded_by(mutex))
/// Of a function: its caller holds this mutex.
#define MAUVE_REQUIRES(mutex) MAUVE_THREAD_ATTRIBUTE(requires_capability(mutex))
/// Of a function: its caller does not hold this mutex, since the function takes it.
#define MAUVE_EXCLUDES(mutex) MAUVE_THREAD_ATTRIBUTE(locks_excluded(mutex))
/// Of a function whose use of a mutex the analysis cannot follow; a comment gives the reason why it
/// is right.
#define MAUVE_NOT_ANALYSED MAUVE_THREAD_ATTRIBUTE(no_thread_safety_analysis)

namespace mauve {

class MAUVE_THREAD_ATTRIBUTE(capability("mutex")) Mutex {
 public:
  /// std::mutex does not offer this protocol, and its native handle may be made anew.
  Mutex() {
    pthread_mutexattr_t attributes;
    pthread_mutexattr_init(&attributes);
    pthread_mutexattr_setprotocol(&attributes, PTHREAD_PRIO_INHERIT);
    pthread_mutex_destroy(mutex_.native_handle());
    pthread_mutex_init(mutex_.native_handle(), &attributes);
    pthread_mutexattr_destroy(&attributes);
  }
  void lock() MAUVE_THREAD_ATTRIBUTE(acquire_capability()) { mutex_.lock(); }
  void unlock() MAUVE_THREAD_ATTRIBUTE(release_capability()) { mutex_.unlock(); }
  [[nodiscard]] bool try_lock() MAUVE_THREAD_ATTRIBUTE(try_acquire_capability(true)) {
    return mutex_.try_lock();
  }

 private:
  friend class MutexLock;
  std::mutex mutex_;
};

/// Holds a mutex until the end of its scope, or until unlock().
class MAUVE_THREAD_ATTRIBUTE(scoped_lockable) MutexLock {
 public:
  explicit MutexLock(Mutex& mutex) MAUVE_THREAD_ATTRIBUTE(acquire_capability(mutex))
      : lock_(mutex.mutex_) {}
  ~MutexLock() MAUVE_THREAD_ATTRIBUTE(release_capability()) = default;
  MutexLock(const MutexLock&) = delete;
  MutexLock& operator=(const MutexLock&) = delete;

  void unlock() MAUVE_THREAD_ATTRIBUTE(release_capability()) { lock_.unlock(); }
  void lock() MAUVE_THREAD_ATTRIBUTE(acquire_capability()) { lock_.lock(); }

 private:
  friend class ConditionVariable;
  std::unique_lock<std::mutex> lock_;
};

/// A condition that a thread with the lock waits for; each wait releases the mutex meanwhile. A
/// predicate is a lambda with MAUVE_REQUIRES(its mutex).
class ConditionVariable {
 public:
  void notify_one() { condition_.notify_one(); }
  void notify_all() { condition_.notify_all(); }

  void wait(MutexLock& lock) { condition_.wait(lock.lock_); }
  template <typename Predicate>
  void wait(MutexLock& lock, Predicate ready) MAUVE_NOT_ANALYSED {
    condition_.wait(lock.lock_, ready);
  }
  /// False: the time is over, and the predicate does not hold.
  template <typename Rep, typename Period, typename Predicate>
  bool wait_for(MutexLock& lock, std::chrono::duration<Rep, Period> time,
                Predicate ready) MAUVE_NOT_ANALYSED {
    return condition_.wait_for(lock.lock_, time, ready);
  }

 private:
  std::condition_variable condition_;
};

}  // namespace mauve
