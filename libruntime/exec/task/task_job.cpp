// SPDX-License-Identifier: LGPL-3.0-or-later
/// One job of a task: user code, and what it leaves.
#include <array>
#include <cstdio>
#include <exception>
#include <string_view>

#include "exec/task/task.h"
#include "model/guard.h"
#include "model/traced.h"
#include "rt/cpu_time.h"
#include "rt/preemption.h"

#include <mauve/component.h>
#include <mauve/fsm.h>
#include <mauve/gate.h>
#include <mauve/job.h>
#include <mauve/request.h>
#include <mauve/task_attributes.h>

namespace mauve::exec {
namespace {

/// The task whose job this thread runs, for mauve::log() and mauve::request().
Task*& this_task() {
  [[gnu::tls_model("initial-exec")]] static thread_local Task* task = nullptr;
  return task;
}

/// Into the ring of the thread: its task may have lost it meanwhile.
void tell_state(TraceKind kind, const FsmState& state, Instant time, bool preempted = false) {
  rt::TraceRing* const ring = ring_of(this_job(), TraceMode::jobs);
  if (ring == nullptr) return;
  ring->push(kind, time, state.trace_name(), preempted && !ring->simulated() ? 1 : 0, 0);
}

}  // namespace

/// What user code leaves; on the stack of the job, since the task may go on without it.
struct Task::JobEnd {
  Task& task;
  Instant at = 0;             ///< start of the job; then when its last state ended
  FsmState* state = nullptr;  ///< the wait it ended in; null: it did not
  bool preempted = false;     ///< something came between
  bool threw = false;
  std::array<char, 128> text{};

  void keep(const char* what) {
    threw = true;
    std::string_view(what).copy(text.data(), text.size() - 1);
  }
  static void run(void* self) {
    auto& end = *static_cast<JobEnd*>(self);
    try {
      end.state = end.task.run_states(end);
    } catch (const std::exception& error) {
      end.keep(text_of(error));
    } catch (...) {
      end.keep("something that is no std::exception");
    }
  }
};

bool Task::run_job(Instant now) {
  begin_job(now);
  // Invariant: whatever user code does to end its job ends here. Only this component is affected;
  // its outputs get their safe values; every resource it held was left.
  JobEnd end{*this, now};
  watched_.busy_since.store(now, std::memory_order_release);
  const rt::Fault fault = rt::rescued(&JobEnd::run, &end, watched_);
  const Gate* inside = fault.happened() ? Gate::poison_and_leave_all() : nullptr;
  if (!fault.happened() && end.threw) inside = this_job().threw_in;
  Instant begun = now;
  const bool ours = watched_.busy_since.compare_exchange_strong(begun, 0);
  if (ours) thrown_out_of_ = inside;
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
  job.lock_waits = {};
  job.implausible = nullptr;
  job.threw_in = nullptr;
  job.lock_bound = current_->shortest_wait;
  this_task() = this;
  job.trace = &trace().ring;
  tell(TraceKind::release, now, release_ - t0_, number_);
  const Instant lateness = now - release_;
  counters_.lateness_last.store(lateness, std::memory_order_relaxed);
  raise(counters_.lateness_max, lateness);
  add<std::uint64_t>(counters_.releases, 1);
  times_ = &current_->bundle->measured->here();
  if (times_->since.load(std::memory_order_relaxed) == 0) {
    times_->since.store(now, std::memory_order_relaxed);
  }
  times_->lateness.add(lateness);
  const bool watched = back_.load(std::memory_order_relaxed) != nullptr;
  const bool has_budget = current_->bundle->task.budget > Duration{0};
  // A system call, so only where it counts: on probation, where the core is judged by it; without a
  // budget, where measured times stand in for it, and the longest job may be just the one that is
  // preempted; and after a preempted job, as the next one may be preempted as well.
  const bool ask = watched || !has_budget || (preempted_ && rt::preemption_is_told());
  cpu_before_ = ask && simulated_ == nullptr ? rt::cpu_time() : Duration{0};
  waits_before_ = watched && simulated_ == nullptr ? rt::waits_so_far() : kUnknown;
  rt::watch_for_preemption();
}

void Task::conclude(Instant start, const JobEnd& end, const rt::Fault& fault) {
  if (fault.happened() || end.threw) write_safe_values();  // before anything is said about it
  if (fault.interrupted) {
    hung();
  } else if (fault.happened()) {
    rt::describe(fault, fault_.text.data(), fault_.text.size());
    on_fault(Cause::crashed);
  } else if (end.threw) {
    fault_.text = end.text;
    on_fault(Cause::threw);
  } else {
    state_ = end.state;
    counters_.fsm_state.store(static_cast<std::uint32_t>(state_->index()),
                              std::memory_order_relaxed);
    account(start, end);
  }
}

void Task::go_on() {
  this_job().lock_bound = current_->shortest_wait;
  this_task() = this;
  if (Published* const next = std::exchange(taking_, nullptr)) {
    take_rest(*next);
    next->answer->failed = true;
  }
  lost_ = current_->bundle->core.get();
  write_safe_values();
  hung();
  this_task() = nullptr;
  watched_.busy_since.store(0);
  acknowledge();
  looked();
}

/// Execution states up to the next synchronization state, which arms the next release. The first
/// begins with the job, each other one where the one before ended: one reading of the clock each.
FsmState* Task::run_states(JobEnd& job) {
  CoreBase& core = *current_->bundle->core;
  std::vector<rt::StateTimes>& all = times_->states;
  const Instant start = job.at;
  FsmState* state = state_ != nullptr ? &state_->next(core) : current_->bundle->fsm->initial();
  while (state->kind() == FsmState::Kind::execution) {
    const std::size_t index = state->index();
    counters_.fsm_state.store(static_cast<std::uint32_t>(index), std::memory_order_relaxed);
    const FsmState& ran = *state;
    tell_state(TraceKind::begin, ran, job.at);
    state->run(core);
    if (this_job().is_detached()) break;  // given up meanwhile
    state = &state->next(core);
    const Instant ended = state_time();
    const bool preempted = rt::preempted();
    if (index < all.size()) all[index].add(ended - job.at, preempted);
    if (preempted) rt::watch_for_preemption();  // of the next state
    job.preempted = job.preempted || preempted;
    job.at = ended;
    tell_state(TraceKind::end, ran, ended, job.preempted);
  }
  if (job.at == start) {  // no state ran, only guards did
    job.at = state_time();
    job.preempted = job.preempted || rt::preempted();
  }
  return state;
}

/// The processor time of the job itself, without the threads that preempted it and the time that
/// the host reports as stolen; none: it was preempted, and the processor time was not asked for.
std::optional<Duration> Task::measure(Instant start, const JobEnd& job) {
  const Instant took = job.at - start;
  preempted_ = job.preempted;
  (preempted_ ? times_->preempted : times_->clean).add(took);
  times_->response.add(job.at - release_);
  if (const Job::LockWaits& waits = this_job().lock_waits; waits.count != 0) {
    times_->lock_waits.add({waits.count, waits.sum, waits.longest});
  }
  std::optional<Duration> used;
  if (!preempted_ || simulated_ != nullptr) used = Duration{took};
  const bool watched = back_.load(std::memory_order_relaxed) != nullptr;
  if (simulated_ == nullptr && cpu_before_ > Duration{0} && (preempted_ || watched)) {
    const Duration on_processor = rt::cpu_time() - cpu_before_;
    used = used ? std::min(*used, on_processor) : on_processor;
  }
  const bool longest = used && used->count() > counters_.used_max.load(std::memory_order_relaxed);
  if (longest && held_up_since(release_) == Duration{0}) raise(counters_.used_max, used->count());
  return used;
}

/// Advances the component's clock by the wait, and counts a job that ended too late.
void Task::account(Instant start, const JobEnd& job) {
  const TaskAttributes& task = current_->bundle->task;
  const Instant released = release_;
  const Instant end = job.at;
  const std::optional<Duration> used = measure(start, job);
  wait_ = state_->duration();
  release_ = released + wait_.count();
  counters_.next_release.store(release_ - t0_, std::memory_order_relaxed);
  counters_.execution_last.store(end - start, std::memory_order_relaxed);
  raise(counters_.execution_max, end - start);
  tell(TraceKind::wait, end, release_ - t0_, preempted_ && simulated_ == nullptr,
       state_->trace_name());
  if (task.budget > Duration{0} && end - start > task.budget.count()) {
    add<std::uint64_t>(counters_.over_budget, 1);
    add<std::uint64_t>(times_->over_budget, 1);
    tell(TraceKind::budget, end, end - start, static_cast<std::uint64_t>(task.budget.count()));
  }
  const Instant deadline =
      task.deadline > Duration{0} ? std::min(release_, released + task.deadline.count()) : release_;
  const bool late = end > deadline;
  if (late) count_overrun(end - deadline);
  if (evidence_.overran(late, task.overrun_limit)) overran_too_often(task);
  if (this_job().implausible != nullptr) add<std::uint64_t>(counters_.implausible, 1);
  if (back_.load(std::memory_order_relaxed) != nullptr) {
    watch_over({released, start, end, Duration{late ? end - deadline : 0}, used});
  } else {
    evidence_.note(late);
  }
}

void Task::count_overrun(Instant by) {
  add<std::uint64_t>(counters_.overruns, 1);
  add<std::uint64_t>(times_->overruns, 1);
  const std::uint64_t overruns = counters_.overruns.load(std::memory_order_relaxed);
  tell(TraceKind::overrun, clock_.now(), by, overruns);
  note(rt::EventKind::overrun, LogLevel::warning, by, static_cast<std::int64_t>(overruns));
}

void Task::overran_too_often(const TaskAttributes& task) {
  if (task.on_overrun == OnOverrun::stop) {
    write_safe_values();
    park(ComponentState::stopped);
  } else if (task.on_overrun == OnOverrun::fallback && relief_.load() != nullptr) {
    std::snprintf(fault_.text.data(), fault_.text.size(), "overran %u times in 64 jobs",
                  task.overrun_limit);
    record_fault(Cause::overruns);
    failed_.fail(Cause::overruns, release_);  // the standby core takes over at the next release
  }
}

}  // namespace mauve::exec

namespace mauve {
namespace {

/// Null outside a job, and for a thread that was given up.
exec::Task* speaking() { return this_job().is_detached() ? nullptr : exec::this_task(); }

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
