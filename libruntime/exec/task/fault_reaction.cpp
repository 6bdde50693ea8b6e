// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/task/fault_reaction.h"

#include <array>
#include <cstdio>
#include <string_view>

#include "exec/task/task_context.h"
#include "exec/task/write_quietly.h"
#include "exec/update/task_update.h"
#include "rt/thread/crash_handler.h"

#include <mauve/detail/job.h>
#include <mauve/fsm.h>
#include <mauve/host/component.h>
#include <mauve/host/task_attributes.h>
#include <mauve/shell.h>

namespace mauve::exec {

bool FaultReaction::may_roll_back() const {
  const TaskUpdate* const back = task_.mailbox.back();
  if (back == nullptr || back->decision->instant() == kClosed) return false;
  return !back->rollback->only_undo() || back->rollback->rolls_back();
}

bool FaultReaction::judges() const {
  const TaskUpdate* const back = task_.mailbox.back();
  return back != nullptr && !back->rollback->only_undo();
}

/// Its rollback was overtaken by another change, which the task has not applied yet.
bool FaultReaction::awaits_rollback() const {
  const TaskUpdate* const next = task_.mailbox.pending();
  return next != nullptr && next->rollback != nullptr &&
         next->decision->state() == Decision::State::committed;
}

void FaultReaction::check_on_probation(const JobUse& job) {
  FaultRecord& fault = task_.report.fault();
  const PortBase* const port = this_job().implausible;
  task_.inherits_implausible = task_.inherits_implausible && port != nullptr;
  if (port != nullptr && !task_.inherits_implausible) {
    copy_text(fault.text, port->name());
    record(Cause::implausible);
    return trigger_rollback();
  }
  const TaskUpdate& current = *task_.current;
  const Evidence::Rules rules{current.tolerated, current.window};
  const JobTiming timing = task_.meter.timing_of(job, current.bundle->task, task_.wait);
  const Evidence::Verdict verdict = task_.evidence.weigh(timing, rules);
  task_.report.counters().suspected.store(task_.evidence.suspicious(rules),
                                          std::memory_order_relaxed);
  if (verdict == Evidence::Verdict::none) return;
  fault.text.fill(0);
  if (verdict == Evidence::Verdict::over_budget) {
    std::snprintf(fault.text.data(), fault.text.size(),
                  "in too many jobs, the last one %lld us of %lld us",
                  static_cast<long long>(job.used.value_or(Duration{0}) / 1us),
                  static_cast<long long>(current.bundle->task.budget / 1us));
  }
  record(verdict == Evidence::Verdict::overruns ? Cause::overruns : Cause::over_budget);
  trigger_rollback();
}

/// The record holds the text already.
void FaultReaction::record(Cause cause) {
  FaultRecord& fault = task_.report.fault();
  const Counters& counters = task_.report.counters();
  fault.time = task_.clock.now();
  fault.cause = cause;
  fault.job = counters.releases.load(std::memory_order_relaxed);
  fault.failed_in_lock = task_.failed_in_lock;
  copy_text(fault.core, task_.current->bundle->core_type.name);
  const auto& states = task_.current->bundle->fsm->states();
  const std::size_t index = counters.fsm_state.load(std::memory_order_relaxed);
  copy_text(fault.state, index < states.size() ? states[index]->name() : std::string_view());
}

void FaultReaction::trigger_rollback() {
  const TaskUpdate* const back = task_.mailbox.back();
  if (back == nullptr) return;
  if (back->rollback->only_undo()) return static_cast<void>(back->rollback->close());
  back->rollback->trigger(task_.clock, task_.report.fault(), &task_.report);
}

bool FaultReaction::may_recover() const {
  if (may_roll_back() || awaits_rollback()) return true;
  if (task_.failed.is_hopeless()) return false;
  return task_.failed.cause() == Cause::overruns ||
         task_.current->bundle->task.on_fault.action != FaultPolicy::Action::stop;
}

void FaultReaction::pass_release() {
  if (!may_recover()) return task_.park(ComponentState::faulted);
  task_.show_core();  // too many late jobs, and the next core waits
  task_.miss(1, task_.clock.now());
  task_.arm(task_.release + task_.current->grid.count());
}

void FaultReaction::fail(Cause cause) {
  report(cause);
  trigger_rollback();
  task_.failed.fail(cause, task_.clock.now());
  if (!may_recover()) return task_.park(ComponentState::faulted);
  task_.show_core();
  task_.wait = task_.current->grid;
  task_.arm(task_.release + task_.wait.count());
}

/// Counts the failure and records it for status, trace and log.
void FaultReaction::report(Cause cause) {
  add<std::uint64_t>(task_.report.counters().faults, 1);
  record(cause);
  task_.report.record(TraceKind::fault, task_.report.fault().time, 0, 0,
                      static_cast<std::uint32_t>(cause));
  log_fault(cause);
}

void FaultReaction::log_fault(Cause cause) {
  const FaultRecord& fault = task_.report.fault();
  rt::Event event{fault.time, rt::EventKind::faulted, LogLevel::error, nullptr, {}, {}, {}};
  event.a = LogArgument(static_cast<std::int64_t>(cause));
  std::string_view(fault.text.data()).copy(event.text.data(), event.text.size() - 1);
  const auto& states = task_.current->bundle->fsm->states();
  const std::size_t index = task_.report.counters().fsm_state.load(std::memory_order_relaxed);
  if (index < states.size()) {
    event.literal = states[index]->name().data();
    event.b = LogArgument(states[index]->name().size());
  }
  task_.report.events().push(event);
}

void FaultReaction::write_safe_values() {
  const Bundle& bundle = *task_.current->bundle;
  rt::Watched& watched = task_.watch.watched();
  for (const PortBase* port : bundle.shell->ports()) {
    const Binding* binding = (*bundle.bindings)[port->index()].get();
    if (binding == nullptr) continue;
    const Instant begin = task_.clock.now();
    watched.keeps_thread.store(true);
    watched.busy_since.store(begin);
    write_quietly(*port, *binding, true, watched);
    watched.busy_since.store(0);
    watched.keeps_thread.store(false);
  }
}

void FaultReaction::describe_hang() {
  FaultRecord& fault = task_.report.fault();
  std::snprintf(fault.text.data(), fault.text.size(), "its job ran longer than %lld ms",
                static_cast<long long>(task_.current->bound / 1ms));
}

void FaultReaction::fail_as_hung() {
  describe_hang();
  fail(Cause::hung);
}

Cause FaultReaction::describe(const rt::Fault& fault, bool hung,
                              const std::array<char, 128>& thrown) {
  auto& text = task_.report.fault().text;
  if (hung) {
    describe_hang();
    return Cause::hung;
  }
  if (fault.happened()) {
    rt::describe(fault, text.data(), text.size());
    return Cause::crashed;
  }
  text = thrown;
  return Cause::threw;
}

void FaultReaction::fail_in_hand_over(const rt::Fault& fault) {
  task_.failed_in_lock = nullptr;
  write_safe_values();
  auto& text = task_.report.fault().text;
  const auto begun = std::string_view("its converter: ").copy(text.data(), text.size());
  if (fault.interrupted) {
    std::snprintf(&text.at(begun), text.size() - begun, "ran longer than %lld ms",
                  static_cast<long long>(task_.current->bound / 1ms));
  } else {
    rt::describe(fault, &text.at(begun), text.size() - begun);
  }
  fail(fault.interrupted ? Cause::hung : Cause::crashed);
}

void FaultReaction::react_to_overruns() {
  if (rt::is_dying()) return;
  const TaskAttributes& attributes = task_.current->bundle->task;
  if (attributes.on_overrun == OnOverrun::stop) {
    write_safe_values();
    task_.park(ComponentState::stopped);
  } else if (attributes.on_overrun == OnOverrun::fallback && task_.mailbox.standby() != nullptr) {
    auto& text = task_.report.fault().text;
    std::snprintf(text.data(), text.size(), "overran %u times in 64 jobs",
                  attributes.overrun_limit);
    record(Cause::overruns);
    // The standby core takes over at the next release.
    task_.failed.fail(Cause::overruns, task_.release);
  }
}

void FaultReaction::park_for_good(const char* why) {
  auto& text = task_.report.fault().text;
  std::snprintf(text.data(), text.size(), "%s", why);
  report(Cause::hung);
  task_.report.counters().without_thread.store(true);
  task_.park(ComponentState::faulted);
}

}  // namespace mauve::exec
