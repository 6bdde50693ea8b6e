// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/relief.h"

#include <algorithm>
#include <optional>

#include "exec/commit.h"
#include "model/left_behind.h"

namespace mauve::exec {
namespace {

using Action = FaultPolicy::Action;

/// Decided for ever: a relief waits for a fault, not for an instant.
Transaction& standing_decision() {
  static Transaction decision(0, Transaction::State::committed);
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

/// It took over: what the task runs is what the model shows.
void take_note(System& system, Deployed& deployed) {
  const StandingBy taken = std::exchange(deployed.relief, {});
  ComponentBase& component = *deployed.component;
  retire(*component.bundle(), *taken.member->next, system.free);
  const bool again = taken.member->restart;
  component.install(taken.member->next);
  taken.member->made.forget();
  system.free.keep(taken.content);
  if (again) deployed.restarts.push_back(system.runner->now());
  Outcome outcome;
  outcome.kind = again ? Outcome::Kind::restarted : Outcome::Kind::fell_back;
  outcome.began = system.generation;
  outcome.generation = ++system.generation;
  outcome.component = component.name();
  outcome.reason = deployed.task->fault();
  outcome.cores = {component.bundle()->core_type.name};
  system.outcomes.push_back(std::move(outcome));
}

std::optional<Edit> relief_of(const System& system, const Deployed& deployed) {
  const Bundle& bundle = *deployed.component->bundle();
  const FaultPolicy& policy = bundle.task.on_fault;
  const auto& fallback = deployed.component->fallback();
  Edit edit;
  edit.component = deployed.component->name();
  const bool falls_back =
      policy.action == Action::fallback || bundle.task.on_overrun == OnOverrun::fallback;
  if (falls_back && fallback) {
    if (bundle.core_type.name == fallback->core.name) return std::nullopt;  // it is in force
    edit.core = fallback->core;
    edit.properties = fallback->properties;
    return edit;
  }
  if (policy.action != Action::restart) return std::nullopt;
  const Instant now = system.runner->now();
  const auto recent =
      std::count_if(deployed.restarts.begin(), deployed.restarts.end(),
                    [&](Instant restart) { return now - restart <= policy.per.count(); });
  if (static_cast<unsigned>(recent) >= policy.restarts) return std::nullopt;
  edit.core = bundle.core_type;
  edit.state = StatePolicy::drop;
  return edit;
}

/// Tasks go back, or are back already, to bundles that the model does not show yet.
bool is_led_back(const System& system) {
  return system.probation != nullptr && system.probation->way_back()->leads_back();
}

/// False: the task has one, or runs with another bundle than the relief was made for.
bool stand_by(const System& system, Task& task, std::unique_ptr<Published> relief) {
  if (!task.stand_by(*relief)) return false;
  Published* const standing = relief.release();
  if (!is_led_back(system) || !task.withdraw_relief(*standing)) return true;
  leave_behind(std::shared_ptr<Published>(standing));  // its thread may be about to look
  return false;
}

}  // namespace

std::vector<Change> wanted_reliefs(System& system) {
  if (is_led_back(system)) return {};
  std::vector<Change> wanted;
  for (const Deployed& deployed : system.deployed) {
    const bool ready = deployed.relief.content != nullptr || deployed.hidden || deployed.changing;
    if (ready || deployed.state() == ComponentState::faulted) continue;
    if (auto edit = relief_of(system, deployed)) wanted.push_back({{*edit}});
  }
  return wanted;
}

Status put_reliefs_in_readiness(System& system) {
  for (const Change& change : wanted_reliefs(system)) {
    Result<PreparedChange> prepared = prepare_change(system, change);
    if (!prepared) return prepared.error();
    put_in_readiness(system, *prepared);
  }
  return ok();
}

void put_in_readiness(System& system, PreparedChange& prepared) {
  if (is_led_back(system)) return;
  const std::shared_ptr<PreparedChange::Content> content = prepared.share();
  for (PreparedMember& member : content->members) {
    Deployed* deployed = system.find(member.component->name());
    const bool current = deployed != nullptr && !deployed->changing && !deployed->relief.content &&
                         member.component->bundle() == member.base;
    if (!current) continue;
    const FaultPolicy& policy = member.base->task.on_fault;
    member.restart = member.state == StatePolicy::drop;
    forget_old_restarts(*deployed, policy, system.runner->now());
    auto published = make_published(member);
    published->taken_as = TakenAs::relief;
    published->transaction = &standing_decision();
    if (member.restart) published->back_off = back_off(policy, deployed->restarts.size());
    deployed->relief = {content, &member, published->answer};
    if (!stand_by(system, *deployed->task, std::move(published))) deployed->relief = {};
  }
}

void look_after_reliefs(System& system) {
  for (Deployed& deployed : system.deployed) {
    StandingBy& relief = deployed.relief;
    if (relief.content == nullptr) continue;
    const auto progress = relief.answer->progress.load(std::memory_order_acquire);
    if (progress == Published::Progress::done) {
      take_note(system, deployed);
    } else if (progress == Published::Progress::given_back && !deployed.changing) {
      // A change made it useless. In its first job it is neither.
      system.free.keep(std::exchange(relief, {}).content);
    }
  }
}

}  // namespace mauve::exec
