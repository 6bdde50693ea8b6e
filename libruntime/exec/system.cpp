// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/system.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <optional>

#include "base/duration.h"
#include "base/name.h"
#include "exec/admission.h"
#include "exec/commit.h"
#include "exec/last_words.h"
#include "exec/placement.h"
#include "exec/probation.h"
#include "exec/relief.h"
#include "exec/safe_values.h"
#include "rt/measured.h"
#include "rt/memory.h"
#include "rt/process.h"

namespace mauve::exec {
namespace {

constexpr int kDeployerPriority = 98;

/// Checks what real time needs. Realtime::prefer turns a refusal into a warning.
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

Duration longest_wait(const Bundle& bundle) {
  Duration longest{0};
  for (const FsmState* state : bundle.fsm->states()) longest = std::max(longest, state->duration());
  return longest;
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

/// Releases that pass while its thread is late or in a job: it counts them when it comes to them.
/// The newest one still runs, and so does the one whose job is under way.
std::uint64_t passing(const Deployed& deployed, const ComponentStatus& status, Instant since_t0) {
  const Bundle& bundle = *deployed.component->bundle();
  const Duration overdue = Duration{since_t0} - status.next_release;
  const Duration wait = longest_wait(bundle);
  const bool skips = bundle.task.on_overrun == OnOverrun::skip;
  if (!skips || wait <= Duration{0} || overdue < wait) return 0;
  const auto due = static_cast<std::uint64_t>(overdue / wait);
  return deployed.task->busy_since() > 0 ? due - 1 : due;
}

/// Until a job ends, `release` is its own; which wait it will end in is not known before. So the
/// longest one is its time, and as much again passes before it is called late.
Duration lateness_of(const Bundle& bundle, Duration release, Instant since_t0) {
  const Duration longest = longest_wait(bundle);
  const Duration time = bundle.task.deadline > Duration{0} ? bundle.task.deadline : longest;
  const Duration late = Duration{since_t0} - release - time;
  return late > longest ? late : Duration{0};
}

/// T0 is far enough ahead that every thread waits for it by then.
void release_all(System& system) {
  system.runner->settle();
  std::optional<rt::Boost> boost;
  if (system.realtime) boost.emplace(kDeployerPriority);
  system.t0 = system.runner->now() + system.runner->lead(system.deployed.size()).count();
  for (Deployed& deployed : system.deployed) {
    deployed.task->begin(first_bundle(*deployed.component, Mode::run), system.t0);
  }
  system.runner->open();
}

std::unique_ptr<Runner> make_runner(const DeployOptions& options) {
  return options.simulated ? make_simulation() : make_threads(options.machine.wake);
}

}  // namespace

std::unique_ptr<Published> first_bundle(const ComponentBase& component, Mode mode) {
  auto first = std::make_unique<Published>();
  first->bundle = component.bundle();
  first->nearby = std::make_shared<const Nearby>(*first->bundle);
  first->bound = bound_of(*component.bundle());
  first->has_safe_values = has_safe_values(*component.bundle());
  first->grid = component.fsm().grid();
  first->shortest_wait = component.fsm().shortest_wait();
  first->mode = mode;
  return first;
}

std::shared_ptr<Task> new_task(const System& system, const ComponentBase& component) {
  return std::make_shared<Task>(component.name(), system.runner->clock(), system.runner->noise());
}

Status start_thread(System& system, Deployed& deployed) {
  const TaskAttributes& task = deployed.component->bundle()->task;
  const int priority = system.realtime ? task.priority : 0;
  Status started = system.runner->add(
      *deployed.task, {deployed.component->name(), priority, deployed.cpus, task.stack});
  if (!started) return started;
  deployed.priority = task.priority;
  deployed.realtime = system.realtime && system.runner->is_fifo(*deployed.task, task.priority);
  return ok();
}

System::System(Architecture& its_architecture, DeployOptions its_options)
    : architecture(its_architecture), options(its_options), runner(make_runner(options)) {}
System::~System() = default;

Deployed* System::find(std::string_view component) {
  for (Deployed& candidate : deployed) {
    if (!candidate.hidden && candidate.component->name() == component) return &candidate;
  }
  return nullptr;
}

Deployed* System::find(const ComponentBase& component) {
  for (Deployed& candidate : deployed) {
    if (candidate.component == &component) return &candidate;
  }
  return nullptr;
}

void System::forget_departed() {
  if (departed.use_count() > 1) return;
  for (Deployed& one : *departed) free.keep(std::move(one.task));
  departed->clear();
}

Result<ComponentBase*> System::component(std::string_view name) const {
  if (ComponentBase* found = architecture.find_component(name)) return found;
  std::vector<std::string> names;
  for (const ComponentBase* known : architecture.components()) names.push_back(known->name());
  const std::string nearest = nearest_name(name, names);
  return refuse(Errc::unknown_name, std::string(name), "there is no component of this name",
                nearest.empty() ? "" : "did you mean " + nearest + "?");
}

Status bring_up(System& system) {
  if (system.up)
    return refuse(Errc::wrong_state, system.architecture.name(), "is deployed already");
  if (Status configured = system.architecture.configure(); !configured) return configured;
  int highest = 1;
  for (ComponentBase* component : system.architecture.components()) {
    const TaskAttributes& task = component->bundle()->task;
    if (Status sound = check_cpus(task, component->name()); !sound) return sound;
    highest = std::max(highest, task.priority);
    Deployed deployed;
    deployed.component = component;
    component->bundle()->measured->reset();  // it may have been deployed before
    deployed.cpus = task.cpus;               // who is pinned counts for who is placed
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
  if (ready && !system.options.simulated) ready = prepare_last_words(system);
  if (!ready) {
    system.runner = make_runner(system.options);
    system.deployed.clear();
    return ready;
  }
  release_all(system);
  system.generation = system.options.first_generation;
  system.up = true;
  Status reliefs = put_reliefs_in_readiness(system);
  if (!reliefs) static_cast<void>(bring_down(system, 2s));
  return reliefs;
}

Incident incident_of(const System& system, const FaultRecord& record) {
  Incident incident{record.time,
                    std::string(to_string(record.cause)),
                    record.text.data(),
                    record.core.data(),
                    record.state.data(),
                    record.job,
                    {}};
  for (const ResourceBase* resource : system.architecture.resources()) {
    if (&resource->gate() == record.inside) incident.resource = resource->name();
  }
  return incident;
}

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
  status.releases = counters.releases.load(std::memory_order_relaxed);
  status.missed = counters.missed.load(std::memory_order_relaxed);
  status.overruns = counters.overruns.load(std::memory_order_relaxed);
  status.faults = counters.faults.load(std::memory_order_relaxed);
  status.over_budget = counters.over_budget.load(std::memory_order_relaxed);
  status.lateness_max = Duration{counters.lateness_max.load(std::memory_order_relaxed)};
  status.lateness_last = Duration{counters.lateness_last.load(std::memory_order_relaxed)};
  status.execution_max = Duration{counters.execution_max.load(std::memory_order_relaxed)};
  status.execution_last = Duration{counters.execution_last.load(std::memory_order_relaxed)};
  status.period = bundle.fsm->grid();
  status.next_release = Duration{counters.next_release.load(std::memory_order_relaxed)};
  status.watchdog = deployed.task->bound(deployed.realtime);
  status.restored = counters.restored.load(std::memory_order_relaxed);
  const Instant failed_at = deployed.task->failed_core().at();
  if (status.state == ComponentState::running && failed_at != 0) {
    const bool hopeless =
        deployed.task->failed_core().is_hopeless();  // it parks as soon as its thread looks
    status.state = hopeless ? ComponentState::faulted : ComponentState::recovering;
    if (!hopeless) status.recovery = recovery_of(system, deployed, failed_at);
  }
  if (status.state == ComponentState::running) {
    status.missed += passing(deployed, status, system.runner->now() - system.t0);
    status.late = lateness_of(bundle, status.next_release, system.runner->now() - system.t0);
  }
  if (status.state == ComponentState::faulted || status.state == ComponentState::recovering) {
    status.incident = incident_of(system, deployed.task->fault());
    status.fault = status.incident->text;
  }
  return status;
}

}  // namespace mauve::exec
