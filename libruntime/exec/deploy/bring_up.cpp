// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/deploy/bring_up.h"

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <string>
#include <utility>

#include "base/duration.h"
#include "exec/admission/admission.h"
#include "exec/admission/placement.h"
#include "exec/deploy/crash_handler.h"
#include "exec/deploy/shutdown.h"
#include "exec/prepare/prepare.h"
#include "exec/recovery/standby.h"
#include "exec/system/make_update.h"
#include "exec/system/system.h"
#include "rt/process/memory.h"
#include "rt/process/process.h"
#include "rt/time/measured.h"

#include <mauve/host/architecture.h>

namespace mauve::exec {
namespace {

constexpr int kDeployerPriority = 98;

/// Checks the rights that real time needs. Realtime::prefer turns a refusal into a warning.
Status check_privileges(System& system, int highest) {
  system.realtime = false;
  if (system.options.simulated || system.options.realtime == Realtime::off) return ok();
  Status fifo = rt::may_use_fifo(highest);
  Status memory = rt::lock_memory();
  system.realtime = fifo.has_value();
  for (const Status* status : {&fifo, &memory}) {
    if (*status) continue;
    if (system.options.realtime == Realtime::require) return *status;
    system.warnings.push_back("timing is not guaranteed: " + status->error().message + " (" +
                              status->error().hint + ")");
  }
  return ok();
}

/// A job that loops is ended at its bound; before that the kernel may stop all its neighbours.
void warn_of_throttling(System& system) {
  const auto runtime = rt::file_text("/proc/sys/kernel/sched_rt_runtime_us");
  if (!runtime || runtime->starts_with("-")) return;
  const Duration limit = std::chrono::microseconds(std::atoll(runtime->c_str()));
  std::string names;
  for (const Deployed& deployed : system.deployed) {
    const Bundle& bundle = *deployed.component->bundle();
    if (bound_of(bundle) < limit) continue;
    names += (names.empty() ? "" : ", ") + deployed.component->name();
  }
  if (names.empty()) return;
  system.warnings.push_back(
      "throttling: a job of " + names + " that loops is ended later than after " +
      format_duration(limit) +
      ", when the kernel stops all real-time threads of its CPU for the rest of "
      "the second (declare a shorter watchdog, or set sched_rt_runtime_us)");
}

/// T0 is far enough ahead that every thread waits for it by then.
void release_all(System& system) {
  system.runner->settle();
  std::optional<rt::Boost> boost;
  if (system.realtime) boost.emplace(kDeployerPriority);
  system.t0 = system.runner->now() + system.runner->lead(system.deployed.size()).count();
  for (Deployed& deployed : system.deployed) {
    const Mode mode = system.may_run(deployed.component->name()) ? Mode::run : Mode::park;
    deployed.task->begin(first_bundle(*deployed.component, mode), system.t0);
  }
  system.runner->open();
}

Status ready_standby_cores(System& system) {
  for (const Change& change : wanted_standby_cores(system)) {
    Result<PreparedChange> prepared = prepare_change(system, change);
    if (!prepared) return about_standby(change, prepared.error());
    put_in_readiness(system, *prepared);
  }
  return ok();
}

}  // namespace

Status bring_up(System& system) {
  if (system.up)
    return refuse({Errc::wrong_state, "deployed_already"}, system.architecture.name(),
                  "is deployed already");
  if (Status configured = system.architecture.configure(); !configured) return configured;
  int highest = 1;
  for (ComponentBase* component : system.architecture.components()) {
    const TaskAttributes& task = component->bundle()->task;
    if (Status sound = check_cpus(task, component->name()); !sound) return sound;
    highest = std::max(highest, task.priority);
    Deployed deployed;
    deployed.component = component;
    component->bundle()->measured->reset();  // it may have been deployed before
    deployed.cpus = task.cpus;               // placement counts pinned tasks
    deployed.task = new_task(system, *component);
    system.deployed.push_back(std::move(deployed));
  }
  for (Deployed& deployed : system.deployed) place(system, deployed);
  Status ready = check_privileges(system, highest);
  if (ready && system.realtime) warn_of_throttling(system);
  if (ready) ready = admit_deployment(system);
  for (Deployed& deployed : system.deployed) {
    if (ready) ready = start_thread(system, deployed);
  }
  if (ready && !system.options.simulated) ready = prepare_crash_handler(system);
  if (!ready) {
    system.runner = make_runner(system.options);
    system.deployed.clear();
    return ready;
  }
  release_all(system);
  system.generation = system.options.first_generation;
  system.up = true;
  Status standby_cores = ready_standby_cores(system);
  if (!standby_cores) static_cast<void>(bring_down(system, 2s));
  return standby_cores;
}

}  // namespace mauve::exec
