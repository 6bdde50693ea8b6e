// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/recovery/standby.h"

#include "base/thread_role.h"

#include <algorithm>
#include <optional>

#include "base/duration.h"
#include "exec/admission/timing_model.h"
#include "exec/recovery/incident.h"
#include "exec/recovery/probations.h"
#include "exec/system/books.h"
#include "exec/system/make_update.h"
#include "exec/system/prepared.h"
#include "model/job/keep_for_abandoned.h"

namespace mauve::exec {
namespace {

using Action = FaultPolicy::Action;

/// Decided for ever: a standby core waits for a fault, not for an instant.
Decision& standing_decision() {
  static Decision decision(0, Decision::State::committed);
  return decision;
}

/// Twice as long before each next restart.
Duration back_off(const FaultPolicy& policy, std::size_t restarts) {
  return policy.back_off * (std::int64_t{1} << std::min<std::size_t>(restarts, 16));
}

void forget_old_restarts(Deployed& deployed, const FaultPolicy& policy, Instant now) {
  std::erase_if(deployed.restarts,
                [&](Instant restart) { return now - restart > policy.per.count(); });
}

std::size_t recent_restarts(const System& system, const Deployed* deployed,
                            const FaultPolicy& policy) {
  if (deployed == nullptr) return 0;
  const Instant now = system.runner->now();
  return static_cast<std::size_t>(
      std::count_if(deployed->restarts.begin(), deployed->restarts.end(),
                    [&](Instant restart) { return now - restart <= policy.per.count(); }));
}

/// The standby core took over, so the model shows the bundle that the task runs.
void take_note(System& system, Deployed& deployed) {
  const StandbyCore used = std::exchange(deployed.standby, {});
  const FaultRecord& fault = used.answer->fault;
  ComponentBase& component = *deployed.component;
  if (!is_timed_alike(*component.bundle(), *used.member->next)) {
    deployed.timed = system.runner->now();
  }
  retire(*component.bundle(), *used.member->next, system.retired);
  static_cast<void>(
      deployed.task->mailbox().reclaim());  // frees the updates before; their elements stay
  const bool again = used.member->restart;
  ++system.revision;
  component.install(used.member->next);
  used.member->made.forget();
  system.retired.keep(used.content);
  if (again) deployed.restarts.push_back(system.runner->now());
  Outcome outcome;
  outcome.kind = again ? Outcome::Kind::restarted : Outcome::Kind::fell_back;
  outcome.began = system.generation;
  outcome.generation = ++system.generation;
  outcome.component = component.name();
  outcome.reason = fault.text.data();
  outcome.incident = incident_of(system, fault);
  outcome.cores = {component.bundle()->core_type.name};
  system.outcomes.push_back(std::move(outcome));
}

/// The component stays failed.
void leave_failed(System& system, Deployed& deployed, Instant failed_at, const std::string& why) {
  Outcome outcome;
  outcome.kind = Outcome::Kind::stays_failed;
  outcome.began = outcome.generation = system.generation;
  outcome.component = deployed.component->name();
  outcome.incident = incident_of(system, deployed.task->report().fault());
  outcome.reason = outcome.incident->text += "; " + why;
  outcome.cores = {deployed.component->bundle()->core_type.name};
  system.outcomes.push_back(std::move(outcome));
  deployed.task->core_failure().declare_hopeless(failed_at);
  system.runner->wake(*deployed.task);
}

/// Does the component wait for a standby core that is not there yet, with no other change under
/// way?
bool waits_for_standby(const System& system, const Deployed& deployed) {
  const bool other = deployed.hidden || deployed.changing || deployed.standby.content != nullptr;
  return !other && !is_rolled_back(system) && deployed.task->core_failure().at() != 0 &&
         !deployed.task->core_failure().is_hopeless();
}

using Fallback = std::optional<ComponentBase::Fallback>;

/// Of a component that runs with this bundle; null: it was never restarted.
std::optional<Edit> standby_of(const System& system, const std::string& component,
                               const Bundle& bundle, const Fallback& fallback,
                               const Deployed* deployed) {
  const FaultPolicy& policy = bundle.task.on_fault;
  Edit edit;
  edit.member = component;
  const bool falls_back =
      policy.action == Action::fallback || bundle.task.on_overrun == OnOverrun::fallback;
  if (falls_back && fallback) {
    if (bundle.core_type.name == fallback->core.name) return std::nullopt;  // it is in force
    edit.core = fallback->core;
    edit.properties = fallback->properties;
    edit.values = Values::defaults;
    edit.state = StatePolicy::offer;
    return edit;
  }
  if (policy.action != Action::restart) return std::nullopt;
  if (recent_restarts(system, deployed, policy) >= policy.restarts) return std::nullopt;
  edit.core = bundle.core_type;
  edit.state = StatePolicy::drop;
  return edit;
}

/// Empty: a standby core is wanted.
std::string why_no_standby(const System& system, const Deployed& deployed) {
  const ComponentBase& component = *deployed.component;
  if (system.runner->has_abandoned(deployed.task.get())) {
    return "a thread that does not return is still inside this component";
  }
  const Bundle& bundle = *component.bundle();
  if (standby_of(system, component.name(), bundle, component.fallback(), &deployed)) return {};
  const FaultPolicy& policy = bundle.task.on_fault;
  if (policy.action == Action::restart) {
    return "all " + std::to_string(policy.restarts) + " restarts within " +
           format_duration(policy.per) + " are used up";
  }
  return component.fallback() ? "this is the fallback core itself" : "there is no fallback core";
}

/// False: the task has one, or runs with another bundle than the standby core was made for.
bool stand_by(const System& system, Task& task, std::unique_ptr<TaskUpdate> standby) {
  if (!task.mailbox().stand_by(*standby)) return false;
  TaskUpdate* const standing = standby.release();
  if (!is_rolled_back(system) || !task.mailbox().claim_standby(*standing)) return true;
  keep_for_abandoned(std::shared_ptr<TaskUpdate>(standing));  // its thread may be about to look
  return false;
}

}  // namespace

std::vector<Change> wanted_standby_cores(System& system) {
  MAUVE_ON_THREAD(control);
  if (is_rolled_back(system)) return {};
  std::vector<Change> wanted;
  for (const Deployed& deployed : system.deployed) {
    const bool ready = deployed.standby.content != nullptr || deployed.hidden || deployed.changing;
    // One that is faulted has it when it is started again.
    if (ready || system.runner->has_abandoned(deployed.task.get())) continue;
    const ComponentBase& component = *deployed.component;
    auto edit =
        standby_of(system, component.name(), *component.bundle(), component.fallback(), &deployed);
    if (edit) wanted.push_back({{*edit}});
  }
  return wanted;
}

std::optional<Edit> standby_of(System& system, const PreparedChange::Content& change,
                               const PreparedMember& member) {
  const bool same = member.next == member.base && member.part != Part::joins;
  if (same || member.part == Part::leaves) return std::nullopt;
  const std::string& name = member.component->name();
  const Fallback* fallback = &member.component->fallback();
  for (const NewFallback& other : change.fallbacks) {
    if (other.component == name) fallback = &other.fallback;
  }
  const Deployed* deployed = member.part == Part::joins ? nullptr : system.find(name);
  return standby_of(system, name, *member.next, *fallback, deployed);
}

std::unique_ptr<TaskUpdate> make_standby(PreparedMember& standby, std::size_t restarts) {
  standby.restart = standby.state == StatePolicy::drop;
  auto update = make_update(standby);
  update->applied_as = AppliedAs::standby;
  update->decision = &standing_decision();
  if (standby.restart) {
    update->back_off = back_off(standby.base->task.on_fault, restarts);
  }
  return update;
}

void put_in_readiness(System& system, PreparedChange& prepared) {
  MAUVE_ON_THREAD(control);
  if (is_rolled_back(system)) return;
  const std::shared_ptr<PreparedChange::Content> content = prepared.share();
  for (PreparedMember& member : content->members) {
    Deployed* deployed = system.find(member.component->name());
    const bool current = deployed != nullptr && !deployed->changing && !deployed->standby.content &&
                         member.component->bundle() == member.base;
    if (!current) continue;
    forget_old_restarts(*deployed, member.base->task.on_fault, system.runner->now());
    auto update = make_standby(member, deployed->restarts.size());
    deployed->standby = {content, &member, update->answer};
    if (!stand_by(system, *deployed->task, std::move(update))) deployed->standby = {};
  }
}

void look_after_standby_cores(System& system) {
  MAUVE_ON_THREAD(control);
  for (Deployed& deployed : system.deployed) {
    StandbyCore& standby = deployed.standby;
    if (standby.content == nullptr) continue;
    const auto progress = standby.answer->progress.load(std::memory_order_acquire);
    if (progress == TaskUpdate::Progress::done) {
      take_note(system, deployed);
    } else if (progress == TaskUpdate::Progress::given_back && !deployed.changing) {
      // A change made it useless. In its first job it is neither.
      system.retired.keep(std::exchange(standby, {}).content);
    }
  }
  for (Deployed& deployed : system.deployed) {
    // The failure is read first: the decision below names it, and a later failure is another one.
    const Instant failed_at = deployed.task->core_failure().at();
    if (!waits_for_standby(system, deployed)) continue;
    const std::string why = why_no_standby(system, deployed);
    if (!why.empty()) leave_failed(system, deployed, failed_at, why);
  }
}

bool holds_stale_standby(const System& system) {
  MAUVE_ON_THREAD(control);
  return std::any_of(system.deployed.begin(), system.deployed.end(), [](const Deployed& deployed) {
    return deployed.standby.content != nullptr && deployed.component != nullptr &&
           deployed.standby.member->base != deployed.component->bundle();
  });
}

void refuse_standby(System& system, std::string_view component, const std::string& why) {
  MAUVE_ON_THREAD(control);
  Deployed* deployed = system.find(component);
  if (deployed == nullptr) return;
  const Instant failed_at = deployed->task->core_failure().at();
  if (waits_for_standby(system, *deployed)) leave_failed(system, *deployed, failed_at, why);
}

Recovery recovery_of(const System& system, const Deployed& deployed, Instant failed_at) {
  MAUVE_ON_THREAD(control);
  const ComponentBase& component = *deployed.component;
  const FaultPolicy& policy = component.bundle()->task.on_fault;
  Recovery recovery;
  if (is_rolled_back(system)) {
    recovery.way = Recovery::Way::rollback;
  } else if (policy.action == Action::restart) {
    const std::size_t used = recent_restarts(system, &deployed, policy);
    const Instant due = failed_at + back_off(policy, used).count();
    recovery.way = Recovery::Way::restart;
    recovery.restarts_left = policy.restarts - std::min<std::size_t>(used, policy.restarts);
    recovery.in = Duration{std::max<Instant>(due - system.runner->now(), 0)};
  } else {
    recovery.way = Recovery::Way::fallback;
  }
  return recovery;
}

Error about_standby(const Change& standby, Error error) {
  const Edit& edit = standby.edits.front();
  const std::string core = edit.member + ".core";
  const bool inside = error.at == core || error.at.starts_with(core + ".");
  if (edit.state == StatePolicy::offer && inside) {
    error.at.replace(0, core.size(), edit.member + ".fallback_core");
  }
  return error;
}

}  // namespace mauve::exec
