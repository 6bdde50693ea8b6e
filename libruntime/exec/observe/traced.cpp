// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/observe/traced.h"

#include "base/thread_role.h"

#include <string>

#include "exec/admission/admission.h"
#include "exec/system/system.h"

#include <mauve/fsm.h>
#include <mauve/host/architecture.h>
#include <mauve/host/component.h>
#include <mauve/host/resource.h>

namespace mauve::exec {
namespace {

TracedComponent look_at_component(const Deployed& deployed, Instant t0) {
  const Bundle& bundle = *deployed.component->bundle();
  TracedComponent traced;
  traced.name = deployed.component->name();
  traced.type = deployed.component->type().name;
  traced.core = bundle.core_type.name;
  traced.change = deployed.shown;
  traced.priority = deployed.priority;
  traced.cpus = deployed.cpus;
  traced.scheduled = deployed.scheduled - t0;
  traced.timed = deployed.timed - t0;
  traced.realtime = deployed.realtime;
  traced.period = bundle.fsm->grid();
  traced.offset = bundle.task.offset;
  traced.deadline = bundle.task.deadline;
  traced.budget = bundle.task.budget;
  for (const FsmState* state : bundle.fsm->states()) {
    const bool waits = state->kind() == FsmState::Kind::synchronization;
    traced.states.push_back({std::string(state->name()), waits, state->duration()});
  }
  traced.initial = bundle.fsm->initial()->name();
  return traced;
}

}  // namespace

TracedSystem traced(System& system) {
  MAUVE_ON_THREAD(control);
  TracedSystem traced;
  traced.architecture = system.architecture.name();
  traced.t0 = system.t0;
  const Responses known = responses(system);
  for (const Deployed& deployed : system.deployed) {
    if (deployed.component == nullptr || deployed.hidden) continue;
    traced.components.push_back(look_at_component(deployed, system.t0));
    const auto bound = known.bounds.find(deployed.component->name());
    if (bound == known.bounds.end()) continue;
    traced.components.back().bound = bound->second;
    traced.components.back().measured = known.measured;
  }
  for (const ResourceBase* resource : system.architecture.resources()) {
    traced.resources.push_back(resource->name());
  }
  return traced;
}

}  // namespace mauve::exec
