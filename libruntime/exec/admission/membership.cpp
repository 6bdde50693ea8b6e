// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/admission/membership.h"

#include "base/thread_role.h"

#include <algorithm>
#include <utility>

#include "base/mutex.h"
#include "exec/admission/placement.h"
#include "exec/system/events.h"
#include "exec/system/make_update.h"
#include "exec/system/trace_records.h"
#include "model/job/keep_for_abandoned.h"

#include <mauve/host/component.h>

namespace mauve::exec {
namespace {

/// A thread that is parked ends at once.
constexpr Duration kEndOfThread = 500ms;

}  // namespace

Result<Deployed*> let_in(System& system, ComponentBase& component) {
  MAUVE_ON_THREAD(control);
  if (Status sound = check_cpus(component.bundle()->task, component.name()); !sound) {
    return sound.error();
  }
  Deployed joining;
  joining.component = &component;
  joining.hidden = true;
  joining.task = new_task(system, component);
  joining.task->begin(first_bundle(component, Mode::park), system.t0);
  place(system, joining);
  if (Status started = start_thread(system, joining); !started) return started.error();
  const MutexLock lock(system.members);
  system.deployed.push_back(std::move(joining));
  return &system.deployed.back();
}

bool let_go(System& system, Deployed& deployed) {
  MAUVE_ON_THREAD(control);
  const bool ended =
      system.runner->end(*deployed.task, system.runner->now() + kEndOfThread.count()) &&
      !system.runner->has_abandoned(deployed.task.get());
  deployed.ended = ended;
  if (!ended) {
    deployed.component->abandon();
    keep_for_abandoned(deployed.task);  // its thread still runs in it
    keep_for_abandoned(system.runner);
  }
  keep_last_events(system, deployed);
  keep_last_trace(system, deployed);
  system.retired.keep(std::exchange(deployed.standby, {}).content);
  deployed.component = nullptr;
  const MutexLock lock(system.members);
  const auto here = std::find_if(system.deployed.begin(), system.deployed.end(),
                                 [&](const Deployed& one) { return &one == &deployed; });
  system.departed->splice(system.departed->end(), system.deployed, here);
  return ended;
}

}  // namespace mauve::exec
