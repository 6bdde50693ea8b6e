// SPDX-License-Identifier: LGPL-3.0-or-later
/// One job of a task: user code, and what it leaves.
#include <array>
#include <cstdio>
#include <exception>
#include <string_view>

#include "exec/task.h"
#include "model/traced.h"
#include "rt/cpu_time.h"
#include "rt/preemption.h"

#include <mauve/gate.h>
#include <mauve/job.h>
#include <mauve/request.h>

namespace mauve::exec {
namespace {

/// The task whose job this thread runs, for mauve::log() and mauve::request().
Task*& this_task() {
  [[gnu::tls_model("initial-exec")]] static thread_local Task* task = nullptr;
  return task;
}

/// Into the ring of the thread: its task may have lost it meanwhile. The time it told, for what
/// follows at once; `time` 0: it is not at hand.
Instant tell_state(TraceKind kind, const FsmState& state, Instant time) {
  rt::TraceRing* const ring = ring_of(this_job(), TraceMode::jobs);
  if (ring == nullptr) return 0;
  const bool preempted = kind == TraceKind::end && !ring->simulated() && rt::preempted();
  if (time == 0) time = ring->now();
  ring->push(kind, time, state.trace_name(), preempted ? 1 : 0, 0);
  return time;
}

}  // namespace

/// What user code leaves; on the stack of the job, since the task may go on without it.
struct Task::JobEnd {
  Task& task;
  FsmState* state = nullptr;  ///< the wait it ended in; null: it did not
  bool threw = false;
  std::array<char, 128> text{};

  void keep(const char* what) {
    threw = true;
    std::string_view(what).copy(text.data(), text.size() - 1);
  }
  static void run(void* self) {
    auto& end = *static_cast<JobEnd*>(self);
    try {
      end.state = end.task.run_states();
    } catch (const std::exception& error) {
      end.keep(error.what());
    } catch (...) {
      end.keep("something that is no std::exception");
    }
  }
};

bool Task::run_job(Instant now) {
  begin_job(now);
  // Invariant: whatever user code does to end its job ends here. Only this component is affected;
  // its outputs get their safe values; every resource it held was left.
  JobEnd end{*this};
  watched_.busy_since.store(now, std::memory_order_release);
  const rt::Fault fault = rt::rescued(&JobEnd::run, &end, watched_);
  if (fault.signal != 0) Gate::poison_and_leave_all();
  Instant begun = now;
  const bool ours = watched_.busy_since.compare_exchange_strong(begun, 0);
  if (ours) conclude(now, end, fault);
  Job& job = this_job();
  rt::end_preemption_watch();
  this_task() = nullptr;
  job.trace = nullptr;
  job.start = 0;
  job.release = 0;
  job.running = false;
  return ours;
}

void Task::begin_job(Instant now) {
  Job& job = this_job();
  job.start = now;
  job.release = release_;
  job.running = true;
  job.implausible = nullptr;
  job.lock_bound = current_->shortest_wait;
  this_task() = this;
  job.trace = &trace().ring;
  tell(TraceKind::release, now, release_ - t0_, number_);
  const Instant lateness = now - release_;
  counters_.lateness_last.store(lateness, std::memory_order_relaxed);
  raise(counters_.lateness_max, lateness);
  add<std::uint64_t>(counters_.releases, 1);
  const bool watched = back_.load(std::memory_order_relaxed) != nullptr;
  const bool has_budget = current_->bundle->task.budget > Duration{0};
  // A system call, so only where the next best guess is that it will be needed.
  const bool ask = rt::preemption_is_told() ? preempted_ : watched && has_budget;
  cpu_before_ = ask ? rt::cpu_time() : Duration{0};
  rt::watch_for_preemption();
}

void Task::conclude(Instant start, const JobEnd& end, const rt::Fault& fault) {
  if (fault.signal != 0 || end.threw) write_safe_values();  // before anything is said about it
  if (fault.interrupted) {
    hung();
  } else if (fault.signal != 0) {
    rt::describe(fault, fault_.data(), fault_.size());
    on_fault(Cause::crashed);
  } else if (end.threw) {
    fault_ = end.text;
    on_fault(Cause::threw);
  } else {
    state_ = end.state;
    counters_.fsm_state.store(static_cast<std::uint32_t>(state_->index()),
                              std::memory_order_relaxed);
    account(start, clock_.now());
  }
}

void Task::go_on() {
  this_job().lock_bound = current_->shortest_wait;
  this_task() = this;
  lost_ = current_->bundle->core.get();
  write_safe_values();
  hung();
  this_task() = nullptr;
  watched_.busy_since.store(0);
  acknowledge();
  add<std::uint64_t>(looks_, 1);
}

/// Execution states up to the next synchronization state, which arms the next release.
FsmState* Task::run_states() {
  CoreBase& core = *current_->bundle->core;
  FsmState* state = state_ != nullptr ? &state_->next(core) : current_->bundle->fsm->initial();
  Instant ended = 0;  // the state before, just now
  while (state->kind() == FsmState::Kind::execution) {
    counters_.fsm_state.store(static_cast<std::uint32_t>(state->index()),
                              std::memory_order_relaxed);
    tell_state(TraceKind::begin, *state, ended);
    state->run(core);
    if (this_job().detached.load(std::memory_order_relaxed)) break;  // given up meanwhile
    ended = tell_state(TraceKind::end, *state, 0);
    if (!state->transitions().empty()) ended = 0;  // its guards take time
    state = &state->next(core);
  }
  return state;
}

/// What the job itself used of the processor, as far as it can be told.
void Task::measure(Instant start, Instant end) {
  preempted_ = rt::preempted();
  if (!preempted_) {
    raise(counters_.used_max, end - start);
  } else if (cpu_before_ > Duration{0}) {
    raise(counters_.used_max, (rt::cpu_time() - cpu_before_).count());
  }
}

/// Advances the component's clock by the wait, and counts a job that ended too late.
void Task::account(Instant start, Instant end) {
  const TaskAttributes& task = current_->bundle->task;
  const Instant released = release_;
  wait_ = state_->duration();
  release_ = released + wait_.count();
  counters_.next_release.store(release_ - t0_, std::memory_order_relaxed);
  counters_.execution_last.store(end - start, std::memory_order_relaxed);
  raise(counters_.execution_max, end - start);
  measure(start, end);
  tell(TraceKind::wait, end, release_ - t0_, preempted_ && simulated_ == nullptr,
       state_->trace_name());
  if (task.budget > Duration{0} && end - start > task.budget.count()) {
    add<std::uint64_t>(counters_.over_budget, 1);
    tell(TraceKind::budget, end, end - start, static_cast<std::uint64_t>(task.budget.count()));
  }
  const Instant deadline =
      task.deadline > Duration{0} ? std::min(release_, released + task.deadline.count()) : release_;
  const bool late = end > deadline;
  if (late) count_overrun(task, end - deadline);
  if (this_job().implausible != nullptr) add<std::uint64_t>(counters_.implausible, 1);
  if (back_.load(std::memory_order_relaxed) != nullptr) watch_over(task, start, end, late);
}

void Task::count_overrun(const TaskAttributes& task, Instant by) {
  add<std::uint64_t>(counters_.overruns, 1);
  const std::uint64_t overruns = counters_.overruns.load(std::memory_order_relaxed);
  tell(TraceKind::overrun, clock_.now(), by, overruns);
  note(rt::EventKind::overrun, LogLevel::warning, by, static_cast<std::int64_t>(overruns));
  if (overruns < task.overrun_limit) return;
  if (task.on_overrun == OnOverrun::stop) {
    write_safe_values();
    park(ComponentState::stopped);
  } else if (task.on_overrun == OnOverrun::fallback && relief_.load() != nullptr) {
    std::snprintf(fault_.data(), fault_.size(), "overran %u times", task.overrun_limit);
    failed_ = true;  // its relief takes over at the next release
    relief_from_ = release_;
  }
}

}  // namespace mauve::exec

namespace mauve {
namespace {

/// Null outside a job, and for a thread that was given up.
exec::Task* speaking() {
  return this_job().detached.load(std::memory_order_relaxed) ? nullptr : exec::this_task();
}

}  // namespace

void log_event(LogLevel level, const char* literal, LogArgument a, LogArgument b) {
  exec::Task* task = speaking();
  if (task == nullptr) return;
  task->events().push({job_time(), rt::EventKind::log, level, literal, a, b, {}});
}

bool request(std::string_view transaction) {
  exec::Task* task = speaking();
  return task != nullptr && task->requests().push(job_time(), transaction);
}

}  // namespace mauve
