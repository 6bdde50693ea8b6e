// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/task/job_runner.h"

#include <algorithm>
#include <array>
#include <exception>
#include <string_view>

#include "exec/task/fault_reaction.h"
#include "exec/task/task_context.h"
#include "exec/update/task_update.h"
#include "model/job/guard.h"
#include "model/job/traced.h"
#include "rt/thread/preemption.h"

#include <mauve/detail/job.h>
#include <mauve/detail/resource_lock.h>
#include <mauve/fsm.h>
#include <mauve/host/component.h>
#include <mauve/host/task_attributes.h>
#include <mauve/job.h>
#include <mauve/request.h>

namespace mauve::exec {
namespace {

/// The report of the task whose job this thread runs, for mauve::log() and mauve::request().
TaskReport*& this_report() {
  [[gnu::tls_model("initial-exec")]] static thread_local TaskReport* report = nullptr;
  return report;
}

/// Records into the ring of this thread, which may be abandoned by now.
void record_state(TraceKind kind, const FsmState& state, Instant time, bool preempted = false) {
  rt::TraceRing* const ring = ring_of(this_job(), TraceMode::jobs);
  if (ring == nullptr) return;
  ring->push(kind, time, state.trace_name(), preempted && !ring->simulated() ? 1 : 0, 0);
}

}  // namespace

/// The outcome of user code; on the stack of the job, since the task may go on without it.
struct JobRunner::JobEnd {
  JobRunner& runner;
  Instant at = 0;             ///< start of the job; then when its last state ended
  FsmState* state = nullptr;  ///< the wait it ended in; null: it did not
  bool preempted = false;     ///< something came between
  bool threw = false;
  std::array<char, 128> text;  ///< only when it threw: filling it takes a tenth of a job's time

  JobEnd(JobRunner& its_runner, Instant start) : runner(its_runner), at(start) {}

  void keep(const char* what) {
    threw = true;
    text = {};
    std::string_view(what).copy(text.data(), text.size() - 1);
  }
  template <typename Code>
  void run(Code code) {
    try {
      code();
    } catch (const std::exception& error) {
      keep(text_of(error));
    } catch (...) {
      keep("something that is no std::exception");
    }
  }
  static void run_states(void* self) {
    auto& end = *static_cast<JobEnd*>(self);
    end.run([&end] { end.state = end.runner.run_states(end); });
  }
  static void stop(void* self) {
    auto& end = *static_cast<JobEnd*>(self);
    end.run([&end] { end.runner.task_.current->bundle->core->mauve_stop(); });
  }
};

bool JobRunner::run(Instant now) {
  // The process ends, and safe values are written: no code of the core runs any more, and nothing
  // is accounted for.
  if (task_.watch.is_fenced()) {
    pass_fenced();
    return true;
  }
  begin(now);
  // Invariant: a job ends here, whichever way its user code ends it. Only this component is
  // affected; its outputs get their safe values; every resource it held was left.
  JobEnd end{*this, now};
  rt::Fault fault;
  const bool ours = run_watched(&JobEnd::run_states, end, now, fault);
  if (ours) conclude(now, end, fault);
  leave_job();
  return ours;
}

/// With a wait of its state machine, and not with the grid, which may be nanoseconds: less urgent
/// drivers act on the safe values meanwhile.
void JobRunner::pass_fenced() {
  const Duration wait = std::max(task_.wait, task_.current->shortest_wait);
  task_.arm(task_.release + wait.count());
}

bool JobRunner::run_watched(void (*code)(void*), JobEnd& end, Instant now, rt::Fault& fault) {
  task_.watch.begin(now);
  fault = rt::run_guarded(code, &end, task_.watch.watched());
  const ResourceLock* inside = fault.happened() ? ResourceLock::poison_and_leave_all() : nullptr;
  if (!fault.happened() && end.threw) inside = this_job().threw_in;
  const bool ours = task_.watch.end(now);
  if (ours) task_.failed_in_lock = inside;
  return ours;
}

Job& JobRunner::enter_job(Instant start, Instant release) {
  Job& job = this_job();
  job.start = start;
  job.release = release;
  job.running = true;
  job.lock_waits = {};
  job.implausible = nullptr;
  job.threw_in = nullptr;
  job.lock_bound = task_.current->shortest_wait;
  this_report() = &task_.report;
  return job;
}

void JobRunner::leave_job() {
  Job& job = this_job();
  rt::end_preemption_watch();
  this_report() = nullptr;
  job.trace = nullptr;
  job.start = 0;
  job.release = 0;
  job.step = {};
  job.running = false;
}

bool JobRunner::let_core_stop(const TaskUpdate& next) {
  return next.mode != Mode::park || let_core_stop();
}

/// As a last job, but no release passes and no time is accounted for.
bool JobRunner::let_core_stop() {
  const CoreBase* const core = task_.current->bundle->core.get();
  if (!task_.running || task_.failed || core == task_.abandoned_core) return true;
  if (task_.watch.is_fenced()) return true;
  const Instant now = task_.meter.now();
  enter_job(now, now);
  JobEnd end{*this, now};
  rt::Fault fault;
  const bool ours = run_watched(&JobEnd::stop, end, now, fault);
  if (ours) static_cast<void>(fail_for(now, end, fault));
  leave_job();
  return ours;
}

void JobRunner::begin(Instant now) {
  Job& job = enter_job(now, task_.release);
  const Instant before = std::exchange(task_.last_release, task_.release);
  job.step = before != 0 ? Duration{task_.release - before} : task_.current->shortest_wait;
  job.trace = &task_.report.trace().ring;
  task_.report.record(TraceKind::release, now, task_.release - task_.t0, task_.number);
  Counters& counters = task_.report.counters();
  const Duration lateness{now - task_.release};
  counters.lateness_last.store(lateness.count(), std::memory_order_relaxed);
  raise(counters.lateness_max, lateness.count());
  add<std::uint64_t>(counters.releases, 1);
  const Bundle& bundle = *task_.current->bundle;
  task_.meter.begin(bundle.measured->here(), now, lateness, task_.mailbox.on_probation(),
                    bundle.task.budget > Duration{0});
}

/// Code of the core that began at `start` is over. True: it failed.
bool JobRunner::fail_for(Instant start, const JobEnd& end, const rt::Fault& fault) {
  // The guard may also cut a sleep short, after which the job ends like a healthy one.
  const bool hung = fault.interrupted || (!fault.happened() && task_.watch.is_interrupted(start));
  if (!fault.happened() && !end.threw && !hung) return false;
  faults_.write_safe_values();  // before any record
  faults_.fail(faults_.describe(fault, hung, end.text));
  return true;
}

void JobRunner::conclude(Instant start, const JobEnd& end, const rt::Fault& fault) {
  if (task_.watch.is_fenced()) {  // meanwhile: the job was left between two states
    return pass_fenced();
  }
  if (!fail_for(start, end, fault)) {
    task_.state = end.state;
    task_.report.counters().fsm_state.store(static_cast<std::uint32_t>(end.state->index()),
                                            std::memory_order_relaxed);
    account(start, end);
  }
}

void JobRunner::go_on() {
  this_job().lock_bound = task_.current->shortest_wait;
  this_report() = &task_.report;
  task_.abandoned_core = task_.current->bundle->core.get();
  faults_.write_safe_values();
  faults_.fail_as_hung();
  this_report() = nullptr;
  task_.watch.go_on();
}

/// Execution states up to the next synchronization state, which arms the next release. The first
/// begins with the job, each other one where the one before ended: one reading of the clock each.
FsmState* JobRunner::run_states(JobEnd& job) {
  CoreBase& core = *task_.current->bundle->core;
  std::vector<rt::StateTimes>& all = task_.meter.times().states;
  Counters& counters = task_.report.counters();
  const Instant start = job.at;
  FsmState* state =
      task_.state != nullptr ? &task_.state->next(core) : task_.current->bundle->fsm->initial();
  while (state->kind() == FsmState::Kind::execution) {
    const std::size_t index = state->index();
    counters.fsm_state.store(static_cast<std::uint32_t>(index), std::memory_order_relaxed);
    const FsmState& ran = *state;
    record_state(TraceKind::begin, ran, job.at);
    state->run(core);
    if (this_job().has_no_ports()) break;  // abandoned meanwhile
    state = &state->next(core);
    const Instant ended = task_.meter.now();
    const bool preempted = rt::preempted();
    if (index < all.size()) all[index].add(ended - job.at, preempted);
    if (preempted) rt::watch_for_preemption();  // of the next state
    job.preempted = job.preempted || preempted;
    job.at = ended;
    record_state(TraceKind::end, ran, ended, job.preempted);
  }
  if (job.at == start) {  // no state ran, only guards did
    job.at = task_.meter.now();
    job.preempted = job.preempted || rt::preempted();
  }
  return state;
}

/// Advances the component's clock by the wait, and counts a job that ended too late.
void JobRunner::account(Instant start, const JobEnd& job) {
  const TaskAttributes& attributes = task_.current->bundle->task;
  Counters& counters = task_.report.counters();
  const bool on_probation = task_.mailbox.on_probation();
  task_.implausible = this_job().implausible != nullptr;
  JobUse use{task_.release, start, job.at, Duration{0}, {}};
  use.used = task_.meter.end(use, job.preempted, on_probation, counters);
  task_.wait = task_.state->duration();
  task_.arm(use.released + task_.wait.count());
  counters.elapsed_last.store(use.end - start, std::memory_order_relaxed);
  raise(counters.elapsed_max, use.end - start);
  task_.report.record(TraceKind::wait, use.end, task_.release - task_.t0,
                      task_.meter.was_preempted(), task_.state->trace_name());
  const bool has_budget = attributes.budget > Duration{0};
  if (has_budget && use.used && task_.meter.took_long(use, attributes.budget))
    count_over_budget(use);
  const Instant deadline = attributes.deadline > Duration{0}
                               ? std::min(task_.release, use.released + attributes.deadline.count())
                               : task_.release;
  const bool late = use.end > deadline;
  if (late) use.late = Duration{use.end - deadline};
  if (late) count_overrun(use);
  if (task_.evidence.count_late(late, attributes.overrun_limit)) faults_.react_to_overruns();
  if (faults_.judges()) {
    faults_.check_on_probation(use);
  } else {
    task_.evidence.note(late);
  }
}

void JobRunner::count_over_budget(const JobUse& job) {
  Counters& counters = task_.report.counters();
  const Duration budget = task_.current->bundle->task.budget;
  add<std::uint64_t>(counters.over_budget, 1);
  add<std::uint64_t>(counters.over_present_budget, 1);
  add<std::uint64_t>(task_.meter.times().over_budget, 1);
  raise(task_.meter.times().over_budget_max, job.used->count());
  task_.report.record(TraceKind::budget, job.end, job.used->count(),
                      static_cast<std::uint64_t>(budget.count()));
}

void JobRunner::count_overrun(const JobUse& job) {
  const Duration budget = task_.current->bundle->task.budget;
  const bool took_long = task_.meter.took_long(job, budget > Duration{0} ? budget : task_.wait);
  Counters& counters = task_.report.counters();
  add<std::uint64_t>(counters.overruns, 1);
  add<std::uint64_t>(task_.meter.times().overruns, 1);
  const std::uint64_t overruns = counters.overruns.load(std::memory_order_relaxed);
  task_.report.record(TraceKind::overrun, task_.clock.now(), job.late.count(), overruns);
  task_.report.note(took_long ? rt::EventKind::long_overrun : rt::EventKind::overrun,
                    LogLevel::warning, job.late.count(), static_cast<std::int64_t>(overruns));
}

}  // namespace mauve::exec

namespace mauve {
namespace {

/// Null outside a job, and for an abandoned thread.
exec::TaskReport* speaking() { return this_job().has_no_ports() ? nullptr : exec::this_report(); }

}  // namespace

void log_event(LogLevel level, const char* literal, LogArgument a, LogArgument b) {
  exec::TaskReport* const report = speaking();
  if (report == nullptr) return;
  report->events().push({job_time(), rt::EventKind::log, level, literal, a, b, {}});
}

bool request(std::string_view transaction) {
  exec::TaskReport* const report = speaking();
  return report != nullptr && report->requests().push(job_time(), transaction);
}

}  // namespace mauve
