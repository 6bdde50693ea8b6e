// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/gate.h>

#include "rt/pi_mutex.h"
#include "rt/preemption.h"

#include <utility>

#include <mauve/clock.h>
#include <mauve/job.h>

namespace mauve {

struct Gate::Lock {
  rt::PiMutex mutex;
  std::atomic<std::uint64_t> timeouts{0};
  bool timed = true;
  Instant since = 0;  // held, by a job that nothing has interrupted so far; 0: not, or not timed
  std::atomic<std::int64_t> longest{0};
};

Gate::Gate() : lock_(std::make_unique<Lock>()) {}
Gate::~Gate() = default;

bool Gate::enter() {
  Job& job = this_job();
  if (job.held_count.load(std::memory_order_relaxed) == Job::kMaxHeld) return false;
  if (!lock_->mutex.try_lock()) {
    if (poisoned()) return false;  // who holds it may never leave
    const Duration bound = job.lock_bound > Duration{0} ? job.lock_bound : Duration{1s};
    if (!lock_->mutex.lock_until(MonotonicClock().now() + bound.count())) {
      lock_->timeouts.fetch_add(1, std::memory_order_relaxed);
      return false;
    }
  }
  hold();
  if (deferred_.load(std::memory_order_acquire) != nullptr) visit_deferred(job.release);
  if (!poisoned()) return true;
  leave();
  return false;
}

bool Gate::try_enter() {
  Job& job = this_job();
  if (job.held_count.load(std::memory_order_relaxed) == Job::kMaxHeld) return false;
  if (!lock_->mutex.try_lock()) return false;
  hold();
  return true;
}

/// One writer: a load and a store are enough.
void Gate::hold() {
  Job& job = this_job();
  const std::size_t count = job.held_count.load(std::memory_order_relaxed);
  job.held[count].store(this, std::memory_order_relaxed);
  job.held_count.store(count + 1, std::memory_order_release);
  if (lock_->timed && !rt::preempted()) lock_->since = MonotonicClock().now();
}

void Gate::leave() {
  Job& job = this_job();  // locks nest: the innermost is left first
  job.held_count.store(job.held_count.load(std::memory_order_relaxed) - 1,
                       std::memory_order_relaxed);
  if (const Instant since = std::exchange(lock_->since, 0); since != 0 && !rt::preempted()) {
    const std::int64_t held = MonotonicClock().now() - since;
    if (held > lock_->longest.load(std::memory_order_relaxed)) lock_->longest.store(held);
  }
  lock_->mutex.unlock();
}

void Gate::poison_and_leave_all() {
  Job& job = this_job();
  while (const std::size_t count = job.held_count.load(std::memory_order_relaxed)) {
    Gate& innermost = *job.held[count - 1].load(std::memory_order_relaxed);
    innermost.poison();
    innermost.leave();
  }
}

void Gate::visit_deferred(Instant release) {
  Deferred* deferred = deferred_.load(std::memory_order_acquire);
  if (deferred != nullptr && deferred->visit(release)) forget(*deferred);
}

Duration Gate::longest_hold() const { return Duration{lock_->longest.load()}; }
void Gate::forget_holds() {
  lock_->since = 0;
  lock_->longest.store(0);
}
void Gate::hold_shortly() { lock_->timed = false; }

std::uint64_t Gate::timeouts() const { return lock_->timeouts.load(std::memory_order_relaxed); }

}  // namespace mauve
