// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/detail/resource_lock.h>

#include <algorithm>
#include <memory>
#include <thread>
#include <utility>

#include "model/job/keep_for_abandoned.h"
#include "model/job/traced.h"
#include "rt/thread/float_environment.h"
#include "rt/thread/pi_mutex.h"
#include "rt/thread/preemption.h"

#include <mauve/detail/job.h>
#include <mauve/host/clock.h>

namespace mauve {

/// A resource lock has one; a new one when a thread that never returns holds it.
struct LockState {
  explicit LockState(ResourceLock& its_owner) : owner(its_owner) {}
  ResourceLock& owner;
  rt::PiMutex mutex;
  Instant since = 0;  // held, by a job that nothing has interrupted so far; 0: not, or not timed
  rt::FloatEnvironment floats;  // of the holder, when it entered
  Instant traced = 0;           // when the trace recorded that it is held; 0: it did not
  /// The thread that clears it ends the hold: the holder when it leaves, or the guard that gives it
  /// up.
  std::atomic<const Job*> holder{nullptr};

  [[nodiscard]] bool end_hold_of(const Job& job) {
    const Job* expected = &job;
    return holder.compare_exchange_strong(expected, nullptr, std::memory_order_acq_rel);
  }
};

namespace {

void count_wait(Job& job, Instant began) {
  const Duration waited{MonotonicClock().now() - began};
  job.lock_waits.count += 1;
  job.lock_waits.sum += waited;
  job.lock_waits.longest = std::max(job.lock_waits.longest, waited);
}

}  // namespace

ResourceLock::ResourceLock() : lock_(new LockState(*this)) {}
ResourceLock::~ResourceLock() { delete lock_.load(); }

/// The lock is acquired here and released in leave(), which the analysis of clang does not follow.
bool ResourceLock::enter() MAUVE_NOT_ANALYSED {
  Job& job = this_job();
  if (job.held_count.load(std::memory_order_relaxed) == Job::kMaxHeld) return false;
  LockState& lock = *lock_.load(std::memory_order_acquire);
  Instant waited = 0;
  if (!lock.mutex.try_lock() && !wait_for(lock, waited)) return false;
  if (!hold(lock, waited)) return enter();
  // A thread that was abandoned while it waited changes nothing: a safe value may stand there. The
  // guard that abandons a thread makes all processors pass a barrier before it looks at the held
  // locks.
  std::atomic_signal_fence(std::memory_order_seq_cst);
  const bool abandoned = job.running && job.has_no_ports();
  if (!abandoned && pending_.load(std::memory_order_acquire) != nullptr) apply_pending(job.release);
  if (!abandoned && !poisoned()) return true;
  leave();
  return false;
}

bool ResourceLock::wait_for(LockState& lock, Instant& waited) MAUVE_NOT_ANALYSED {
  if (poisoned()) return false;  // its holder may never leave
  Job& job = this_job();
  const Duration bound = job.lock_bound > Duration{0} ? job.lock_bound : kLongestBudget;
  const Instant begin = MonotonicClock().now();
  const bool got = lock.mutex.lock_until(begin + bound.count());
  count_wait(job, begin);
  if (!got) timeouts_.fetch_add(1, std::memory_order_relaxed);
  rt::TraceRing* const ring = ring_of(job, TraceMode::jobs);
  if (ring == nullptr) return got;
  const Instant now = ring->now();
  waited = std::max<Instant>(now - begin, 0);  // nothing on a clock that stands still
  if (!got) ring->push(TraceKind::timeout, now, trace_name_, 0, waited);
  return got;
}

bool ResourceLock::try_enter() MAUVE_NOT_ANALYSED {
  if (this_job().held_count.load(std::memory_order_relaxed) == Job::kMaxHeld) return false;
  LockState& lock = *lock_.load(std::memory_order_acquire);
  return lock.mutex.try_lock() && hold(lock, 0);
}

/// False when this is not the state of the lock any more: its holder was abandoned, and unlocked it
/// when it came back after all. One writer of the record: a load and a store are enough.
bool ResourceLock::hold(LockState& lock, Instant waited) MAUVE_NOT_ANALYSED {
  if (lock_.load(std::memory_order_acquire) != &lock) {
    lock.mutex.unlock();
    return false;
  }
  Job& job = this_job();
  lock.holder.store(&job, std::memory_order_relaxed);
  job.threw_in = nullptr;
  const std::size_t count = job.held_count.load(std::memory_order_relaxed);
  job.held[count].store(&lock, std::memory_order_relaxed);
  job.held_count.store(count + 1, std::memory_order_release);
  if (!blames_caller_) lock.floats = rt::FloatEnvironment();
  if (timed_ && !rt::preempted()) lock.since = MonotonicClock().now();
  trace_hold(lock, waited);
  return true;
}

/// A lock that is held for some stores only is recorded when a thread had to wait for it.
void ResourceLock::trace_hold(LockState& lock, Instant waited) const {
  const bool worth = timed_ || waited > 0;
  rt::TraceRing* const ring = ring_of(this_job(), worth ? TraceMode::jobs : TraceMode::detail);
  lock.traced = 0;
  if (ring == nullptr) return;
  lock.traced = ring->now(lock.since);
  ring->push(TraceKind::lock, lock.traced, trace_name_, 0, waited);
}

void ResourceLock::trace_leave(LockState& lock, Instant now) const {
  if (lock.traced == 0) return;
  rt::TraceRing* const ring = ring_of(this_job(), TraceMode::jobs);
  if (ring == nullptr) return;
  const Instant left = ring->now(now);
  ring->push(TraceKind::unlock, left, trace_name_, 0, std::max<Instant>(left - lock.traced, 0));
}

void ResourceLock::leave() {
  const Job& job = this_job();  // locks nest: the innermost is left first
  leave(*job.held[job.held_count.load(std::memory_order_relaxed) - 1]);
}

void ResourceLock::leave(LockState& lock) MAUVE_NOT_ANALYSED {
  Job& job = this_job();
  job.held_count.store(job.held_count.load(std::memory_order_relaxed) - 1,
                       std::memory_order_relaxed);
  if (!blames_caller_) lock.floats.put_back();  // the caller goes on as if it had not called
  if (!lock.end_hold_of(job)) return leave_renewed(lock);
  Instant now = 0;
  if (const Instant since = std::exchange(lock.since, 0); since != 0 && !rt::preempted()) {
    now = MonotonicClock().now();
    count_hold(now - since);
  }
  trace_leave(lock, now);
  lock.mutex.unlock();
}

/// Under the lock: one writer at a time.
void ResourceLock::count_hold(std::int64_t held) {
  if (held > longest_.load(std::memory_order_relaxed)) longest_.store(held);
  const std::int64_t declared = declared_.load(std::memory_order_relaxed);
  if (declared == 0 || held <= declared) return;
  over_budget_.store(over_budget_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
}

/// This thread was abandoned meanwhile. A thread that waits for its lock finds out; a lock whose
/// owner ends without leaving it would end the process.
void ResourceLock::leave_renewed(LockState& lock) MAUVE_NOT_ANALYSED {
  while (lock_.load(std::memory_order_acquire) == &lock) std::this_thread::yield();  // in a moment
  lock.mutex.unlock();
}

std::size_t ResourceLock::held() { return this_job().held_count.load(std::memory_order_relaxed); }

const ResourceLock* ResourceLock::poison_and_leave_all(std::size_t kept) {
  const Job& job = this_job();
  const ResourceLock* first = nullptr;
  for (std::size_t count = held(); count > kept; count = held()) {
    LockState& innermost = *job.held[count - 1].load(std::memory_order_relaxed);
    const bool still_holds = innermost.holder.load(std::memory_order_relaxed) == &job;
    if (still_holds) innermost.owner.poison();
    if (first == nullptr && !innermost.owner.blames_caller_) first = &innermost.owner;
    innermost.owner.leave(innermost);
  }
  return first;
}

const ResourceLock* ResourceLock::poison_and_free_all(Job& lost) {
  const ResourceLock* last = nullptr;
  const std::size_t count = lost.held_count.load(std::memory_order_acquire);
  for (std::size_t i = 0; i < count; ++i) {
    LockState& lock = *lost.held[i].load(std::memory_order_relaxed);
    if (!lock.end_hold_of(lost)) continue;  // it has left this one
    lock.owner.poison();                    // before any thread can enter
    lock.owner.renew_lock();
    if (!lock.owner.blames_caller_) last = &lock.owner;
  }
  return last;
}

/// The old one is never freed: its holder may still come back to it.
void ResourceLock::renew_lock() {
  auto fresh = std::make_unique<LockState>(*this);
  keep_for_abandoned(
      std::shared_ptr<LockState>(lock_.exchange(fresh.release(), std::memory_order_acq_rel)));
}

void ResourceLock::apply_pending(Instant release) {
  PendingUpdate* pending = pending_.load(std::memory_order_acquire);
  if (pending != nullptr && pending->apply(release)) forget(*pending);
}

void ResourceLock::forget_times() {
  lock_.load()->since = 0;
  longest_.store(0);
}

}  // namespace mauve
