// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/system/system.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <optional>

#include "base/name.h"
#include "base/thread_role.h"
#include "exec/run/threads.h"

#include <mauve/host/architecture.h>

namespace mauve::exec {

std::shared_ptr<Task> new_task(const System& system, const ComponentBase& component) {
  auto task =
      std::make_shared<Task>(component.name(), system.runner->clock(), system.runner->noise());
  const UserStop* const stop = system.stops.of(component.name());
  task->mailbox().forbid_start(stop == nullptr ? 0 : stop->number);
  return task;
}

Status start_thread(System& system, Deployed& deployed) {
  const TaskAttributes& task = deployed.component->bundle()->task;
  const int priority = system.realtime ? task.priority : 0;
  Status started = system.runner->add(
      *deployed.task, {deployed.component->name(), priority, deployed.cpus, task.stack});
  if (!started) return started;
  deployed.priority = task.priority;
  deployed.scheduled = deployed.timed = system.runner->now();
  deployed.realtime = system.realtime && system.runner->is_fifo(*deployed.task, task.priority);
  return ok();
}

std::unique_ptr<Runner> make_runner(const DeployOptions& options) {
  return options.simulated ? make_simulation() : make_threads(options.machine.wake);
}

System::System(Architecture& its_architecture, DeployOptions its_options)
    : architecture(its_architecture),
      options(its_options),
      runner(make_runner(options)),
      stops(options.stops == nullptr ? own_stops_ : *options.stops) {}
System::~System() = default;

Status System::check_made_from(const std::optional<std::uint64_t>& made_from) const {
  if (!made_from || *made_from == generation_before_stops()) return ok();
  return refuse({Errc::conflict, "changed_meanwhile"}, architecture.name(),
                "changed, for example by a rollback, after this change was made from what was in "
                "force before",
                "try again; `logs` and `history` show what came between");
}

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

bool System::is_away(std::string_view component) const {
  return std::any_of(deployed.begin(), deployed.end(), [component](const Deployed& one) {
    return one.hidden && one.component != nullptr && one.task->name() == component;
  });
}

/// Also the tasks of components that left with a change on probation, and may come back.
void System::obey_stops() {
  MAUVE_ON_THREAD(control);
  stops_obeyed = stops.revision();
  for (Deployed& one : deployed) {
    const UserStop* const stop = stops.of(one.task->name());
    one.task->mailbox().forbid_start(stop == nullptr ? 0 : stop->number);
  }
}

void System::forget_departed() {
  if (departed.use_count() > 1) return;
  for (Deployed& one : *departed) retired.keep(std::move(one.task));
  departed->clear();
}

Result<ComponentBase*> System::component(std::string_view name) const {
  if (ComponentBase* found = architecture.find_component(name)) return found;
  std::vector<std::string> names;
  for (const ComponentBase* known : architecture.components()) names.push_back(known->name());
  const std::string nearest = nearest_name(name, names);
  return refuse({Errc::unknown_name, "unknown_element"}, std::string(name),
                "there is no component of this name",
                nearest.empty() ? "" : "did you mean " + nearest + "?");
}

}  // namespace mauve::exec
