// SPDX-License-Identifier: LGPL-3.0-or-later
/// What a task does about a core that fails, or does not prove itself.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdio>
#include <string_view>

#include "exec/safe_values.h"
#include "exec/task.h"
#include "rt/cpu_time.h"
#include "rt/fence.h"

#include <mauve/job.h>

namespace mauve::exec {
namespace {

/// In place of when a job began: nobody runs the task.
constexpr Instant kLost = -1;

/// One in so many jobs may be late because it began too late: a host that stands still for some
/// milliseconds, and not what was changed. More than that, and the change starves it.
constexpr unsigned kExcused = 8;

/// A job that took no longer would have been in time, had it begun in time.
Instant longest_span(const TaskAttributes& task, Duration wait) {
  return (task.deadline > Duration{0} ? std::min(wait, task.deadline) : wait).count();
}

}  // namespace

/// Is, or will be, led back by the change on probation?
bool Task::leads_back() const {
  const Published* back = back_.load(std::memory_order_acquire);
  return back != nullptr && back->transaction->instant() != kClosed;
}

/// On probation: what is no fault by itself leads back as well.
void Task::watch_over(const TaskAttributes& task, Instant start, Instant end, bool late) {
  const bool held_up = late && end - start <= longest_span(task, wait_);
  overran_ = overran_ << 1U | (late && !held_up ? 1U : 0U);
  held_up_ = held_up_ << 1U | (held_up ? 1U : 0U);
  const auto count = [this](std::uint64_t jobs) {
    return static_cast<unsigned>(std::popcount(jobs & current_->window));
  };
  const unsigned excused = static_cast<unsigned>(std::popcount(current_->window)) / kExcused;
  const PortBase* port = this_job().implausible;
  if (port != nullptr) {
    std::array<char, 64> name{};
    port->name().copy(name.data(), name.size() - 1);
    give_up_core(Cause::implausible, name.data());
  } else if (count(overran_) > current_->tolerated ||
             count(overran_ | held_up_) > current_->tolerated + excused) {
    give_up_core(Cause::overruns, "");
  } else if (task.budget > Duration{0} && end - start > task.budget.count() &&
             used_too_much(task)) {
    give_up_core(Cause::over_budget, "");
  }
}

/// Longer than its budget it took. On the processor's clock too? A job that others preempt is not
/// to blame; one whose time nobody asked for is not judged, but the next one will be.
bool Task::used_too_much(const TaskAttributes& task) const {
  if (!preempted_) return true;
  return cpu_before_ > Duration{0} && rt::cpu_time() - cpu_before_ > task.budget;
}

/// Sets the way back off. The core goes on until its next release.
void Task::give_up_core(Cause cause, const char* what) {
  const Published* back = back_.load(std::memory_order_acquire);
  if (back == nullptr) return;
  back->way_back->set_off(clock_, cause, this, what);
}

/// A failed core runs no more; its releases pass until something takes over.
void Task::skip_job() {
  if (!leads_back() && relief_.load(std::memory_order_acquire) == nullptr) {
    return park(ComponentState::faulted);
  }
  miss(1, clock_.now());
  release_ += current_->grid.count();
  counters_.next_release.store(release_ - t0_, std::memory_order_relaxed);
}

/// `fault_` says what it was; the safe values are written.
void Task::on_fault(Cause cause) {
  add<std::uint64_t>(counters_.faults, 1);
  const Instant now = clock_.now();
  tell(TraceKind::fault, now, 0, 0, static_cast<std::uint32_t>(cause));
  rt::Event event{now, rt::EventKind::faulted, LogLevel::error, nullptr, {}, {}, {}};
  event.a = LogArgument(static_cast<std::int64_t>(cause));
  std::string_view(fault_.data()).copy(event.text.data(), event.text.size() - 1);
  const auto& states = current_->bundle->fsm->states();
  const std::size_t index = counters_.fsm_state.load(std::memory_order_relaxed);
  if (index < states.size()) {
    event.literal = states[index]->name().data();
    event.b = LogArgument(states[index]->name().size());
  }
  events_.push(event);
  give_up_core(cause, fault_.data());
  const Published* relief = relief_.load(std::memory_order_acquire);
  const bool relieved =
      relief != nullptr && current_->bundle->task.on_fault.action != FaultPolicy::Action::stop;
  if (!leads_back() && !relieved) return park(ComponentState::faulted);
  failed_ = true;
  wait_ = current_->grid;
  release_ += wait_.count();
  relief_from_ = relieved ? clock_.now() + relief->back_off.count() : 0;
  counters_.next_release.store(release_ - t0_, std::memory_order_relaxed);
}

void Task::write_safe_values() { exec::write_safe_values(*current_->bundle, true); }

/// The job ran into its bound.
void Task::hung() {
  std::snprintf(fault_.data(), fault_.size(), "its job ran longer than %lld ms",
                static_cast<long long>(current_->bound / 1ms));
  on_fault(Cause::hung);
}

bool Task::lose_thread(Instant since) {
  if (!watched_.busy_since.compare_exchange_strong(since, kLost)) return false;
  // The next thread tells into a ring of its own: the lost one may be about to write.
  trace_ = new Trace{rt::TraceRing(simulated_), std::unique_ptr<Trace>(trace_.load())};
  if (Job* job = job_.exchange(nullptr)) {
    job->detached.store(true);
    rt::fence_all_threads();  // it writes alone to no exchange from here on: see LatestValue
    Gate::poison_and_free_all(*job);
  }
  return true;
}

void Task::park_for_good(const char* why) {
  std::snprintf(fault_.data(), fault_.size(), "%s", why);
  park(ComponentState::faulted);
}

void Task::runs_on(Job* job) {
  job_.store(job);
  if (job != nullptr && fenced_.load()) job->detached.store(true);
}

/// Whichever thread is given to it later, too.
void Task::fence() {
  fenced_.store(true);
  if (Job* job = job_.load()) job->detached.store(true);
}

}  // namespace mauve::exec
