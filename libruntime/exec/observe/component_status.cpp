// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/observe/component_status.h"

#include "exec/recovery/incident.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "exec/recovery/standby.h"

#include <mauve/detail/port_base.h>
#include <mauve/fsm.h>
#include <mauve/host/component.h>
#include <mauve/shell.h>

namespace mauve::exec {
namespace {

Duration longest_wait(const Bundle& bundle) {
  Duration longest{0};
  for (const FsmState* state : bundle.fsm->states()) longest = std::max(longest, state->duration());
  return longest;
}

/// The missed releases that the thread has not counted yet, because it is late or in a job. They do
/// not include the newest one, which still runs, and the one whose job is under way.
std::uint64_t passing(const Deployed& deployed, const ComponentStatus& status, Instant since_t0) {
  const Bundle& bundle = *deployed.component->bundle();
  const Duration overdue = Duration{since_t0} - status.next_release;
  const Duration wait = longest_wait(bundle);
  const bool skips = bundle.task.on_overrun == OnOverrun::skip;
  if (!skips || wait <= Duration{0} || overdue < wait) return 0;
  const auto due = static_cast<std::uint64_t>(overdue / wait);
  return deployed.task->watch().busy_since() > 0 ? due - 1 : due;
}

/// How late the job under way is; `release` is its own until it ends. Its wait is not known before,
/// so its time is the deadline, else the longest wait. It counts as late after another longest
/// wait.
Duration lateness_of(const Bundle& bundle, Duration release, Instant since_t0) {
  const Duration longest = longest_wait(bundle);
  const Duration time = bundle.task.deadline > Duration{0} ? bundle.task.deadline : longest;
  const Duration late = Duration{since_t0} - release - time;
  return late > longest ? late : Duration{0};
}

void count_implausible(const Bundle& bundle, ComponentStatus& status) {
  for (const PortBase* port : bundle.shell->ports()) {
    const ImplausibleCount count = port->implausible();
    status.implausible += count.ever;
    status.implausible_of_core += count.of_core;
  }
}

}  // namespace

ComponentStatus look_at(const System& system, const Deployed& deployed) {
  const Counters& counters = deployed.task->counters();
  const Bundle& bundle = *deployed.component->bundle();
  ComponentStatus status;
  status.name = deployed.component->name();
  status.type = deployed.component->type().name;
  status.core = bundle.core_type.name;
  const auto& states = bundle.fsm->states();
  const std::size_t index = counters.fsm_state.load(std::memory_order_relaxed);
  if (index < states.size()) status.fsm_state = states[index]->name();
  status.state = counters.state.load(std::memory_order_acquire);
  status.priority = deployed.priority;
  status.cpus = deployed.cpus;
  status.realtime = deployed.realtime;
  status.changing = deployed.changing;
  status.stopping = deployed.parking;
  status.ran_until_end = deployed.ran_until_end;
  status.releases = counters.releases.load(std::memory_order_relaxed);
  status.missed = counters.missed.load(std::memory_order_relaxed);
  status.overruns = counters.overruns.load(std::memory_order_relaxed);
  status.faults = counters.faults.load(std::memory_order_relaxed);
  status.over_budget = counters.over_budget.load(std::memory_order_relaxed);
  status.over_present_budget = counters.over_present_budget.load(std::memory_order_relaxed);
  status.lateness_max = Duration{counters.lateness_max.load(std::memory_order_relaxed)};
  status.lateness_last = Duration{counters.lateness_last.load(std::memory_order_relaxed)};
  status.elapsed_max = Duration{counters.elapsed_max.load(std::memory_order_relaxed)};
  status.elapsed_last = Duration{counters.elapsed_last.load(std::memory_order_relaxed)};
  status.used_max = Duration{counters.used_max.load(std::memory_order_relaxed)};
  status.budget = bundle.task.budget;
  status.period = bundle.fsm->grid();
  status.next_release = Duration{counters.next_release.load(std::memory_order_relaxed)};
  status.watchdog = deployed.task->bound(deployed.realtime);
  status.restored = counters.restored.load(std::memory_order_relaxed);
  count_implausible(bundle, status);
  const Instant failed_at = deployed.task->core_failure().at();
  if (status.state == ComponentState::running && failed_at != 0) {
    const bool hopeless =
        deployed.task->core_failure().is_hopeless();  // it parks as soon as its thread looks
    status.state = hopeless ? ComponentState::faulted : ComponentState::recovering;
    if (!hopeless) status.recovery = recovery_of(system, deployed, failed_at);
  }
  if (status.state == ComponentState::running) {
    status.missed += passing(deployed, status, system.runner->now() - system.t0);
    status.late = lateness_of(bundle, status.next_release, system.runner->now() - system.t0);
  }
  if (status.state == ComponentState::faulted || status.state == ComponentState::recovering) {
    status.incident = incident_of(system, deployed.task->report().fault());
    status.fault = status.incident->text;
  }
  return status;
}

}  // namespace mauve::exec
