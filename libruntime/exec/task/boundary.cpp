// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/task/boundary.h"

#include <algorithm>
#include <utility>

#include "exec/task/fault_reaction.h"
#include "exec/task/job_runner.h"
#include "exec/task/task_context.h"
#include "exec/task/write_quietly.h"
#include "exec/update/task_update.h"
#include "rt/process/cache.h"

#include <mauve/detail/port_base.h>
#include <mauve/fsm.h>
#include <mauve/host/component.h>
#include <mauve/host/task_attributes.h>
#include <mauve/observable.h>
#include <mauve/shell.h>
#include <mauve/state.h>

namespace mauve::exec {
namespace {

/// A change that neither replaces the core nor starts or stops the component leaves a failed core
/// failed. A change on probation forgets the failure: it is judged by the jobs that follow.
bool keeps_core(const TaskUpdate& next, const TaskUpdate& current) {
  if (next.mode != Mode::keep || next.applied_as != AppliedAs::change) return false;
  return next.mode_only || (next.back == nullptr && next.bundle->core == current.bundle->core);
}

/// The first instant base + k * step that is not before `instant`.
Instant next_on_grid(Instant base, Duration step, Instant instant) {
  if (instant <= base || step <= Duration{0}) return base;
  return base + (instant - base + step.count() - 1) / step.count() * step.count();
}

}  // namespace

/// May the task take the update ahead of its armed release? The update must be committed, and the
/// release at or after its instant. A task whose release is due takes the update in cross().
bool Boundary::is_early(const TaskUpdate& next) const {
  const Decision& decision = *next.decision;
  if (decision.state() != Decision::State::committed || !decision.has_instant()) return false;
  return !task_.running || (task_.release >= decision.instant() && !task_.due());
}

bool Boundary::serve() {
  const bool ran = task_.running || task_.waiting;
  if (TaskUpdate* next = task_.mailbox.pending()) {
    if (next->decision->state() == Decision::State::aborted) {
      give_back(*next);
    } else if (is_early(*next)) {
      if (!jobs_.let_core_stop(*next)) return false;
      if (task_.mailbox.claim(*next)) {
        touch(*next);
        if (!take_early(*next)) return false;
      }
    }
  }
  if (TaskUpdate* back = task_.mailbox.back(); back != nullptr && is_early(*back)) {
    if (!jobs_.let_core_stop(*back)) return false;
    if (task_.mailbox.claim_rollback(*back) && !take_early(*back)) return false;
  }
  const bool halts = task_.mailbox.halted() && (task_.running || task_.waiting);
  if (halts && !stand_still()) return false;
  if (task_.failed && task_.running && !faults_.may_recover()) task_.park(ComponentState::faulted);
  // A parked task takes an update at once that the running one would have taken at its release. No
  // thread wakes it for that.
  const bool parks = ran && !task_.running && !task_.waiting;
  return !parks || serve();
}

/// The change takes effect, but a direct stop has priority. Then the component does not run, and
/// its outputs, which may be others, have their safe values before the coordinator goes on.
MAUVE_RUNS_AT_A_SWAP bool Boundary::take_early(TaskUpdate& next) {
  if (!take(next, task_.meter.now())) return false;
  const bool halts = unacknowledged_ != nullptr && task_.mailbox.halted();
  if (halts && !stand_still()) return false;
  acknowledge();
  return true;
}

bool Boundary::cross(Instant now) {
  TaskUpdate* const next = task_.mailbox.pending();
  if (next != nullptr) {
    // The coordinator is late: a member at its instant decides for all that nothing happens.
    const Decision::Verdict verdict = next->decision->at_boundary(task_.release);
    if (verdict == Decision::Verdict::aborted) give_back(*next);
    const bool may = verdict == Decision::Verdict::take;
    if (may && !jobs_.let_core_stop(*next)) return false;
    const bool takes = may && task_.mailbox.claim(*next);
    if (takes && !take(*next, now)) return false;
  }
  return task_.waiting || take_over(now);  // a standby core waits as well
}

bool Boundary::take_over(Instant now) {
  TaskUpdate* const back = task_.mailbox.back();
  const bool goes_back =
      back != nullptr && back->decision->at_boundary(task_.release) == Decision::Verdict::take;
  if (goes_back && !jobs_.let_core_stop(*back)) return false;
  if (goes_back && task_.mailbox.claim_rollback(*back)) return take(*back, now);
  if (!task_.failed || faults_.may_roll_back() || task_.failed.is_hopeless()) return true;
  TaskUpdate* const standby = task_.mailbox.standby();
  if (standby == nullptr || task_.release < task_.failed.at() + standby->back_off.count()) {
    return true;
  }
  if (!task_.mailbox.claim_standby(*standby)) return true;
  standby->answer->fault = task_.report.fault();
  return take(*standby, now);
}

void Boundary::drop_missed(Instant now) {
  if (task_.current->bundle->task.on_overrun != OnOverrun::skip) return;
  const Duration wait = task_.wait;
  if (wait <= Duration{0} || now - task_.release < wait.count()) return;
  const std::int64_t dropped = (now - task_.release) / wait.count();
  task_.arm(task_.release + dropped * wait.count());
  task_.miss(static_cast<std::uint64_t>(dropped), now);
  const std::uint64_t missed = task_.report.counters().missed.load(std::memory_order_relaxed);
  task_.report.note(rt::EventKind::missed, LogLevel::warning, dropped,
                    static_cast<std::int64_t>(missed));
}

/// The coordinator wrote the data that take() touches, often on another CPU, from where each cache
/// line takes 100 ns, or the data was not used since the last job. This function brings it here
/// while the old bundle is still in force.
void Boundary::touch(const TaskUpdate& next) const {
  if (next.barrier != TaskUpdate::Barrier::none) return;
  task_.mailbox.prefetch();  // first, since these lines come while the others are read
  rt::touch(&next, sizeof next);
  rt::touch(next.answer.get(), sizeof *next.answer);
  rt::touch(next.bundle.get(), sizeof *next.bundle);
  rt::touch(next.bundle->measured.get(), sizeof *next.bundle->measured);
  rt::touch(next.state_map.data(), next.state_map.size() * sizeof next.state_map[0]);
  const TaskUpdate& current = *task_.current;
  if (current.bundle->core.get() != task_.abandoned_core) next.hand_over.touch();
  for (const auto& [into, from] : next.observables) rt::touch(into, sizeof *into);
  rt::touch(next.bundle->shell.get(), sizeof *next.bundle->shell);
  rt::touch(&current, sizeof current);
  rt::touch(current.bundle.get(), sizeof *current.bundle);
  rt::touch(this, sizeof *this);
  task_.touch();
  rt::touch_swap_code();
}

MAUVE_RUNS_AT_A_SWAP bool Boundary::take(TaskUpdate& next, Instant begin) {
  acknowledge();  // of a change that is overtaken at the same boundary
  record_applied(next, begin);
  if (next.barrier != TaskUpdate::Barrier::none) return wait_or_resume(next), true;
  if (next.mode_only) keep_bundle(next);
  const bool waited = std::exchange(task_.waiting, false);
  task_.running = task_.running || waited;
  for (const auto& [port, before] : next.safe_writes) write_quietly(*port, *before, true);
  if (next.mode == Mode::park) faults_.write_safe_values();
  // No state is moved out of a core that an abandoned thread may still run.
  const bool whole = task_.current->bundle->core.get() != task_.abandoned_core;
  if (whole && !take_state(next)) return false;
  const bool was_running = task_.running;
  take_rest(next);
  const Instant parked = task_.parked_at;
  next.answer->pause =
      Duration{next.count_gap ? task_.release - parked : task_.meter.now() - begin};
  if (waited) next.answer->pause = skip_gap(next.decision->instant());
  if (was_running && task_.running && !next.mode_only) {
    task_.report.note(rt::EventKind::swapped, LogLevel::info, next.answer->pause.count(),
                      static_cast<std::int64_t>(next.answer->bytes));
  }
  if (next.answer->failed) faults_.fail_in_hand_over(hand_over_fault_);
  return true;
}

/// A standby core is no change of the coordinator: the task keeps the number of its last change.
MAUVE_RUNS_AT_A_SWAP void Boundary::record_applied(const TaskUpdate& next, Instant time) {
  const bool barrier = next.barrier != TaskUpdate::Barrier::none;
  if (!barrier && next.number != 0) task_.number = next.number;
  const AppliedAs as = barrier ? AppliedAs::barrier : next.applied_as;
  const bool has_instant = as != AppliedAs::standby && next.decision->has_instant();
  task_.report.record(TraceKind::applied, time,
                      has_instant ? next.decision->instant() - task_.t0 : -1,
                      barrier ? next.number : task_.number, static_cast<std::uint32_t>(as));
}

/// A converter is code of the new core, so the guard watches it as it watches a job. False: it did
/// not return, and this thread was abandoned in it.
MAUVE_RUNS_AT_A_SWAP bool Boundary::take_state(TaskUpdate& next) {
  const bool converts = next.hand_over.convert != nullptr;
  const Instant begun = converts ? task_.meter.now() : 0;
  if (converts) {
    taking_ = &next;
    task_.watch.begin(begun);
  }
  const rt::Fault fault = next.hand_over.run(task_.watch.watched());
  if (converts) {
    if (!task_.watch.end(begun)) return false;
    taking_ = nullptr;
  }
  next.answer->bytes = next.hand_over.bytes;
  next.answer->failed = fault.happened();
  hand_over_fault_ = fault;
  for (const auto& [into, from] : next.observables) into->continue_from(*from);
  return true;
}

/// Takes everything of the update but the state that the old core hands over. A start resumes a
/// component with a failed core as it resumes a stopped one.
MAUVE_RUNS_AT_A_SWAP void Boundary::take_rest(TaskUpdate& next) {
  const bool was_running = task_.running && !(task_.failed && next.mode == Mode::run);
  next.bundle->shell->use(next.bundle->bindings.get());
  map_state(next);
  TaskUpdate* const old = task_.current;
  put_in_place(next);
  rearm(next, was_running);
  task_.show_core();
  unacknowledged_ = &next;
  task_.mailbox.retire(*old);
}

void Boundary::finish_taking() {
  TaskUpdate* const next = std::exchange(taking_, nullptr);
  if (next == nullptr) return;
  take_rest(*next);
  next->answer->failed = true;
}

/// Lets a running task wait, and a waiting one go on. Other tasks are not affected.
void Boundary::wait_or_resume(TaskUpdate& step) {
  if (step.barrier == TaskUpdate::Barrier::wait) {
    task_.waiting = std::exchange(task_.running, false);
  } else if (std::exchange(task_.waiting, false)) {
    task_.running = true;
    step.answer->pause = skip_gap(step.decision->instant());
  }
  // After a direct stop, values written during a hand-over that came to nothing may be lost.
  const bool stands = !task_.running && !task_.waiting;
  if (stands && task_.mailbox.halted()) faults_.write_safe_values();
  step.answer->progress.store(TaskUpdate::Progress::done, std::memory_order_release);
  task_.mailbox.retire(step);  // last: from there it is freed
}

/// After a barrier: arms the first release at or after its end on the grid that it was on. The ones
/// before are lost. Returns the delay of the next job.
Duration Boundary::skip_gap(Instant until) {
  const Instant armed = task_.release;
  const Duration grid = task_.current->grid;
  if (!task_.running || armed >= until || grid <= Duration{0}) return Duration{0};
  const Instant next = next_on_grid(armed, grid, until);
  task_.miss(static_cast<std::uint64_t>((next - armed) / grid.count()), task_.clock.now(), true);
  task_.arm(next);
  return Duration{next - armed};
}

/// Keeps the bundle of the task: the update was made from an older model, and the task may have
/// been rolled back since.
void Boundary::keep_bundle(TaskUpdate& next) const {
  const TaskUpdate& current = *task_.current;
  if (next.bundle == current.bundle) return;
  next.bundle = current.bundle;  // two counts each; the last one to go is never here
  next.prefetch_set = current.prefetch_set;
  next.grid = current.grid;
  next.shortest_wait = current.shortest_wait;
  next.bound = current.bound;
  next.has_safe_values = current.has_safe_values;
}

/// A standby core for the old bundle is of no use for another bundle.
MAUVE_RUNS_AT_A_SWAP void Boundary::put_in_place(TaskUpdate& next) {
  Mailbox& mailbox = task_.mailbox;
  Counters& counters = task_.report.counters();
  const bool same_bundle = next.bundle == task_.current->bundle;
  if (!keeps_core(next, *task_.current)) task_.failed.forget();
  if (next.other_core || next.bundle->task.budget != task_.current->bundle->task.budget) {
    counters.over_present_budget.store(0, std::memory_order_relaxed);
  }
  task_.current = &next;
  task_.watch.set(next.bound, next.has_safe_values);
  // Also with the same code: a change that cures it slowly, or that concerns it little, stays.
  task_.inherits_implausible = task_.implausible;
  if (next.other_core) {
    if (next.answer->bytes == 0) task_.inherits_implausible = false;
    counters.elapsed_last.store(0, std::memory_order_relaxed);
    counters.elapsed_max.store(0, std::memory_order_relaxed);
    counters.used_max.store(0, std::memory_order_relaxed);
    for (PortBase* port : next.bundle->shell->ports()) port->begin_another_core();
  }
  if (same_bundle && next.back == nullptr && next.standby == nullptr) return;
  task_.evidence.begin_anew(!mailbox.on_probation());
  counters.suspected.store(false, std::memory_order_relaxed);
  if (TaskUpdate* const before = mailbox.exchange_back(std::move(next.back))) {
    mailbox.retire(*before);
  }
  if (task_.failed && next.mode_only) faults_.trigger_rollback();
  if (same_bundle && next.standby == nullptr) return;  // the present standby core stays
  if (TaskUpdate* const standby = mailbox.exchange_standby(std::move(next.standby))) {
    standby->answer->progress.store(TaskUpdate::Progress::given_back, std::memory_order_release);
    mailbox.retire(*standby);
  }
}

MAUVE_RUNS_AT_A_SWAP void Boundary::map_state(const TaskUpdate& next) {
  if (next.restart) {
    task_.state = nullptr;
  } else if (task_.state != nullptr && !next.state_map.empty()) {
    task_.state = next.state_map[task_.state->index()];
  }
}

/// Stops, starts, or goes on at the release that was armed before.
MAUVE_RUNS_AT_A_SWAP void Boundary::rearm(const TaskUpdate& next, bool was_running) {
  if (next.mode == Mode::park) {
    const bool faulted = task_.report.counters().state.load() == ComponentState::faulted;
    if (was_running || (faulted && next.ends_fault)) task_.park(ComponentState::stopped);
  } else if (next.mode == Mode::run && !was_running && next.ends_stop >= task_.mailbox.stop()) {
    start(next);
  } else if (task_.running) {
    keep_phase(next);
  }
}

/// No task that runs is kept waiting for it, so its code is not among that of a swap.
void Boundary::start(const TaskUpdate& next) {
  const Instant armed = task_.release;
  const Instant base = task_.t0 + next.bundle->task.offset.count();
  const Instant earliest = std::max(next.decision->instant(), task_.clock.now());
  const Instant release = next_on_grid(base, next.grid, earliest);
  if (next.count_gap && next.grid > Duration{0} && release > armed) {
    const auto passed = static_cast<std::uint64_t>((release - armed) / next.grid.count());
    task_.miss(passed, task_.clock.now(), true);
  }
  task_.arm(release);
  task_.wait = Duration{0};
  task_.last_release = 0;
  task_.running = true;
  task_.evidence.forget_overruns();
  task_.report.counters().state.store(ComponentState::running, std::memory_order_release);
  task_.report.record(TraceKind::started, task_.clock.now(), release - task_.t0);
  task_.report.note(rt::EventKind::started, LogLevel::info, release - task_.t0);
}

/// Another offset moves the grid, and the armed release to the first instant of the new grid at or
/// after it. A trace records that as a start, since the wait had announced another instant.
MAUVE_RUNS_AT_A_SWAP void Boundary::keep_phase(const TaskUpdate& next) {
  const Instant base = task_.t0 + next.bundle->task.offset.count();
  if (next.offset_changes) {
    task_.arm(next_on_grid(base, next.grid, task_.release));
    task_.report.record(TraceKind::started, task_.clock.now(), task_.release - task_.t0);
  }
}

void Boundary::give_back(TaskUpdate& next) {
  if (!task_.mailbox.claim(next)) return;
  task_.report.record(TraceKind::given_back, task_.clock.now(), 0, next.number);
  task_.report.note(rt::EventKind::aborted, LogLevel::debug);
  next.answer->progress.store(TaskUpdate::Progress::given_back, std::memory_order_release);
}

MAUVE_RUNS_AT_A_SWAP void Boundary::acknowledge() {
  if (unacknowledged_ == nullptr) return;
  TaskUpdate* const applied = std::exchange(unacknowledged_, nullptr);
  applied->answer->progress.store(TaskUpdate::Progress::done, std::memory_order_release);
}

bool Boundary::stand_still() {
  if (!jobs_.let_core_stop()) return false;
  const bool runs = task_.running || task_.waiting;
  task_.waiting = false;
  task_.failed.forget();
  faults_.write_safe_values();
  if (runs) task_.park(ComponentState::stopped);
  return true;
}

std::vector<std::shared_ptr<const Bundle>> Boundary::bundles() const {
  std::vector<std::shared_ptr<const Bundle>> all{task_.current->bundle};
  if (taking_ != nullptr) all.push_back(taking_->bundle);
  return all;
}

}  // namespace mauve::exec
