// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/observe/statistics.h"

#include "base/thread_role.h"

#include "rt/time/measured.h"

#include <mauve/fsm.h>
#include <mauve/host/component.h>

namespace mauve::exec {
namespace {

std::vector<StateStatistics> states_of(const FsmBase& fsm, const rt::JobTimes& times) {
  std::vector<StateStatistics> states;
  for (const FsmState* state : fsm.states()) {
    if (state->kind() != FsmState::Kind::execution || state->index() >= times.states.size())
      continue;
    const rt::StateTimes& its = times.states[state->index()];
    states.push_back({std::string(state->name()), its.clean.look(), its.preempted.look()});
  }
  return states;
}

}  // namespace

ComponentStatistics statistics_of(const System& system, const Deployed& deployed) {
  MAUVE_ON_THREAD(control);
  const Bundle& bundle = *deployed.component->bundle();
  const rt::JobTimes& times = bundle.measured->shown();
  ComponentStatistics all;
  all.name = deployed.component->name();
  all.core = bundle.core_type.name;
  const Instant since = times.since.load(std::memory_order_relaxed);
  if (since != 0) all.since = Duration{since - system.t0};
  all.budget = bundle.task.budget;
  all.missed = times.missed.load(std::memory_order_relaxed);
  all.overruns = times.overruns.load(std::memory_order_relaxed);
  all.over_budget = times.over_budget.load(std::memory_order_relaxed);
  all.over_budget_max = Duration{times.over_budget_max.load(std::memory_order_relaxed)};
  all.lateness = times.lateness.look();
  all.execution = times.clean.look();
  all.preempted = times.preempted.look();
  all.response = times.response.look();
  all.lock_waits = times.lock_waits.look();
  all.states = states_of(*bundle.fsm, times);
  return all;
}

}  // namespace mauve::exec
