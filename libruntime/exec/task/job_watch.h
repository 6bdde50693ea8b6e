// SPDX-License-Identifier: LGPL-3.0-or-later
/// JobWatch: the view of the guard on a task. It has the job under way, the time it may take, and
/// the thread that runs it.
#pragma once

#include <atomic>

#include "rt/thread/run_guarded.h"

#include <mauve/detail/job.h>
#include <mauve/time.h>

namespace mauve {

class ResourceLock;

namespace exec {

class JobWatch {
 public:
  // --- [guard] ----------------------------------------------------------------------------------
  /// How long a job may run on a real-time thread, or on an ordinary one; zero: without a bound.
  [[nodiscard]] Duration bound(bool realtime) const;
  /// When the job under way began, the same instant never twice; 0: none is under way.
  [[nodiscard]] Instant busy_since() const { return watched_.busy_since.load(); }
  /// The job that began then ends where it is, as soon as its thread gets the signal.
  void interrupt(Instant since) { watched_.interrupt.store(since); }
  /// Takes the component away from the thread whose job began then, since the job never returns.
  /// False: the job has ended, or the thread must keep it. The thread must not end meanwhile.
  [[nodiscard]] bool take_from_thread(Instant since);
  /// The lock of the resource in whose service the job of the abandoned thread hangs; null: the job
  /// hangs in its own code. The locks that the thread held are poisoned and free.
  [[nodiscard]] const ResourceLock* cut_off_thread();

  // --- [any] ------------------------------------------------------------------------------------
  /// All that the thread of the task still tries to write or read is dropped from now on, also on
  /// each thread that the task gets later.
  void fence();
  [[nodiscard]] bool is_fenced() const { return fenced_.load(std::memory_order_relaxed); }
  /// The task has safe values to write when it parks.
  [[nodiscard]] bool has_safe_values() const { return has_safe_values_.load(); }

  // --- [rt] the thread of the task --------------------------------------------------------------
  /// The thread calls it first with its Job, and last with null.
  void set_thread_job(Job* job);
  void set(Duration bound, bool has_safe_values);
  /// Did the guard want the job that began then to end? A simulated clock begins at instant 0,
  /// which is also "none": no guard is there.
  [[nodiscard]] bool is_interrupted(Instant since) const {
    return since != 0 && watched_.interrupt.load() == since;
  }
  [[nodiscard]] rt::Watched& watched() { return watched_; }
  void begin(Instant now) { watched_.busy_since.store(now, std::memory_order_release); }
  /// False: another thread has claimed the component of that job.
  [[nodiscard]] bool end(Instant begun) {
    return watched_.busy_since.compare_exchange_strong(begun, 0);
  }
  /// The thread that replaces an abandoned one is ready for its first job.
  void go_on() { watched_.busy_since.store(0); }
  /// Touches the cache lines that a swap writes.
  void touch() const;

 private:
  rt::Watched watched_;
  std::atomic<Job*> job_{nullptr};  // of the task's thread
  std::atomic<bool> fenced_{false};
  std::atomic<std::int64_t> bound_{0};
  std::atomic<bool> has_safe_values_{false};
};

}  // namespace exec
}  // namespace mauve
