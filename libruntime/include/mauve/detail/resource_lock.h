// SPDX-License-Identifier: LGPL-3.0-or-later
/// ResourceLock: one caller at a time through the services of a resource.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>

#include <mauve/detail/data_status.h>
#include <mauve/detail/job.h>
#include <mauve/time.h>

namespace mauve {

/// Runtime only: a change of a resource, applied by the first caller whose job is released at or
/// after its instant. A resource has no thread of its own to do it.
class PendingUpdate {
 public:
  virtual ~PendingUpdate() = default;
  /// Under the lock. `release`: of the caller's job on the monotonic clock, 0 outside a job. True:
  /// it is over, and it is not applied again. Bounded, no heap. [any]
  virtual bool apply(Instant release) = 0;
};

/// The longest lock budget that may be declared, since callers outside of a job wait so long.
inline constexpr Duration kLongestBudget{1s};

/// The priority-inheritance lock of a resource, with a bounded wait and a record of the locks that
/// each thread holds.
class ResourceLock {
 public:
  ResourceLock();
  ~ResourceLock();
  ResourceLock(const ResourceLock&) = delete;
  ResourceLock& operator=(const ResourceLock&) = delete;

  /// Waits no longer than the caller's bound, and not at all for one that is poisoned. False when
  /// that passed first, when the caller holds too many, or when the resource is poisoned; nothing
  /// is held then. [any]
  [[nodiscard]] bool enter();
  /// Never waits, and enters a poisoned resource too. [control]
  [[nodiscard]] bool try_enter();
  void leave();
  [[nodiscard]] std::uint64_t timeouts() const { return timeouts_.load(std::memory_order_relaxed); }
  /// The longest that a caller held it without being interrupted by another thread; 0: none was
  /// measured. For the analysis of response times. [any]
  [[nodiscard]] Duration longest_held() const { return Duration{longest_.load()}; }
  /// Forgets the measured times, because the resource has another core. Under the lock.
  void forget_times();
  /// Declares the lock budget, the longest time that one call keeps the lock; zero: none. Like the
  /// budget of a task, it counts before a measured time. [control]
  void set_budget(Duration longest) { declared_.store(longest.count(), std::memory_order_relaxed); }
  [[nodiscard]] Duration budget() const {
    return Duration{declared_.load(std::memory_order_relaxed)};
  }
  /// Calls that were measured longer than declared. [any]
  [[nodiscard]] std::uint64_t over_budget() const {
    return over_budget_.load(std::memory_order_relaxed);
  }
  /// Declares that it is only held for some loads and stores, so that no hold is timed: reading the
  /// clock would take longer. Before its first caller.
  void hold_shortly() { timed_ = false; }
  /// Declares that only code of the runtime and of the caller runs under it, so a caller that fails
  /// there is itself to blame. Before its first caller.
  void blame_caller() { blames_caller_ = true; }
  /// The name of its resource in a trace.
  void name_in_trace(std::uint32_t name) { trace_name_ = name; }
  [[nodiscard]] bool timed() const { return timed_; }

  /// A caller was aborted in the middle of a service (a crash, a core that did not return): the
  /// data of the core may be half written. Callers are refused until it gets a new core. [any]
  void poison() { poisoned_.store(true, std::memory_order_release); }
  [[nodiscard]] bool poisoned() const { return poisoned_.load(std::memory_order_acquire); }
  /// Under the lock: its core is new, or known to be whole.
  void clear_poison() { poisoned_.store(false, std::memory_order_release); }

  /// Runtime only: how many this thread holds.
  [[nodiscard]] static std::size_t held();
  /// Runtime only: poisons and releases the locks that this thread holds, except the first `kept`:
  /// the job was aborted inside the others. Returns the innermost in whose own code it was; null:
  /// none.
  static const ResourceLock* poison_and_leave_all(std::size_t kept = 0);
  /// Runtime only: poisons all resources that an abandoned thread holds, and gives each a new lock
  /// in place of the one that only that thread could unlock. Takes memory; the thread must not end
  /// meanwhile. Returns the innermost, as above. [guard]
  static const ResourceLock* poison_and_free_all(Job& lost);

  /// Runtime only: the update that the next caller applies. [control]
  void defer(PendingUpdate& pending) { pending_.store(&pending, std::memory_order_release); }
  /// Runtime only: it is not applied again, but a caller may be inside it until the lock was
  /// entered once more. [control]
  void forget(PendingUpdate& pending) {
    PendingUpdate* expected = &pending;
    pending_.compare_exchange_strong(expected, nullptr, std::memory_order_acq_rel);
  }

 private:
  [[nodiscard]] bool wait_for(LockState& lock, Instant& waited);
  [[nodiscard]] bool hold(LockState& lock, Instant waited);
  void trace_hold(LockState& lock, Instant waited) const;
  void trace_leave(LockState& lock, Instant now) const;
  void leave(LockState& lock);
  void leave_renewed(LockState& lock);
  void count_hold(std::int64_t held);
  void renew_lock();
  void apply_pending(Instant release);
  /// An exception leaves its service.
  void note_throw() const {
    Job& job = this_job();
    if (!blames_caller_ && job.threw_in == nullptr) job.threw_in = this;
  }

  friend class ScopedLock;

  std::atomic<LockState*> lock_;
  std::atomic<PendingUpdate*> pending_{nullptr};
  std::atomic<bool> poisoned_{false};
  bool timed_ = true;
  bool blames_caller_ = false;
  std::uint32_t trace_name_ = 0;
  std::atomic<std::uint64_t> timeouts_{0};
  std::atomic<std::int64_t> longest_{0};
  std::atomic<std::int64_t> declared_{0};
  std::atomic<std::uint64_t> over_budget_{0};
};

/// Holds the lock of a resource for a scope; false when it could not be acquired.
class ScopedLock {
 public:
  explicit ScopedLock(ResourceLock& lock) : lock_(lock), entered_(lock.enter()) {}
  ~ScopedLock() {
    if (!entered_) return;
    if (std::uncaught_exceptions() > 0) lock_.note_throw();
    lock_.leave();
  }
  ScopedLock(const ScopedLock&) = delete;
  ScopedLock& operator=(const ScopedLock&) = delete;
  explicit operator bool() const { return entered_; }
  /// Why the lock could not be acquired.
  [[nodiscard]] DataStatus refusal() const {
    return lock_.poisoned() ? DataStatus::poisoned : DataStatus::timed_out;
  }

 private:
  ResourceLock& lock_;
  bool entered_;
};

}  // namespace mauve
