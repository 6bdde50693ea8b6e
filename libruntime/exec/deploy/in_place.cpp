// SPDX-License-Identifier: LGPL-3.0-or-later
/// Swap in place: the paper's way, for hardware that only one core can hold at a time.
#include "exec/deploy/in_place.h"

#include <utility>
#include <vector>

#include "exec/commit/commit.h"

#include "base/thread_role.h"
#include "exec/commit/under_way.h"
#include "exec/observe/component_status.h"
#include "exec/prepare/prepare.h"
#include "exec/recovery/inherit.h"
#include "exec/swap/rewired.h"
#include "exec/system/report_control.h"
#include "model/element/elements.h"
#include "model/element/hand_over.h"
#include "model/job/abandonable_thread.h"

#include <mauve/detail/job.h>
#include <mauve/fsm.h>
#include <mauve/host/change.h>

namespace mauve::exec {
namespace {

using Elements = std::vector<Configurable*>;

/// The elements of a bundle that the other one does not have. A shell may be in both.
Elements elements_of(const Bundle& bundle, const Bundle& other) {
  Elements elements;
  if (bundle.shell != other.shell) elements.push_back(bundle.shell.get());
  elements.push_back(bundle.core.get());
  elements.push_back(bundle.fsm.get());
  return elements;
}

Status configure(const Elements& elements) {
  const NoPorts no_ports;
  return configure_in_order(elements);
}

ComponentState state_of(System& system, const ComponentBase& component) {
  advance(system);
  const Deployed* const deployed = system.find(component.name());
  return deployed == nullptr || deployed->task == nullptr ? ComponentState::stopped
                                                          : look_at(system, *deployed).state;
}

/// The clean-up of a core beside a job that is still in it would pull its device from under it.
bool somebody_is_inside(const System& system, const PreparedMember& member) {
  return system.runner->has_abandoned(nullptr, member.base->core.get());
}

Error still_inside(const PreparedMember& member) {
  return refuse({Errc::wrong_state, "component_abandoned"}, member.component->name(),
                "a job that did not return is still in its core, so the core is not cleaned up",
                "wait until the job has returned, or restart mauved when the robot stands");
}

/// A step that leaves everything as it is but for the mode, and makes no generation.
std::shared_ptr<Ongoing> begin_mode(System& system, PreparedMember member,
                                    bool ends_probation = false) {
  auto content = std::make_unique<PreparedChange::Content>();
  const char* const method = member.mode == Mode::park ? "component.stop" : "component.start";
  content->what = what_of(method, {member.component->name()});
  content->in_place = ends_probation;
  content->step = true;
  content->members.push_back(std::move(member));
  PreparedChange change(std::move(content));
  return begin_commit(system, change);
}

}  // namespace

Result<PreparedChange> prepare_in_place(System& system, const Edit& edit,
                                        std::optional<std::uint64_t> made_from) {
  MAUVE_ON_THREAD(factory);
  Change change{{edit}};
  change.made_from = made_from;
  auto prepared = prepare_change(system, change, false);
  if (!prepared) return prepared;
  const PreparedMember& member = prepared->content().members.front();
  if (somebody_is_inside(system, member)) return still_inside(member);
  return prepared;
}

Result<PreparedChange> prepare_back_in_place(System& system, std::string_view component,
                                             std::shared_ptr<const Bundle> before,
                                             std::optional<ComponentType> type) {
  MAUVE_ON_THREAD(factory);
  const ModelLock::Hold hold(system.model);
  if (!hold)
    return refuse({Errc::timed_out, "preparation_abandoned"}, "deployer",
                  "the change was dropped before it began, since its thread was abandoned");
  const Result<ComponentBase*> found = system.component(component);
  if (!found) return found.error();
  PreparedMember member = member_of(**found, Mode::keep);
  member.next = std::move(before);
  member.type = std::move(type);
  member.restores = true;
  member.restart = true;
  const CoreBase& from = *member.base->core;
  const CoreBase& into = *member.next->core;
  if (!prepare_hand_over(from, into, member.state)) {
    member.state = StatePolicy::drop;
    if (Status dropped = prepare_hand_over(from, into, member.state); !dropped) {
      return dropped.error();
    }
  }
  auto content = std::make_unique<PreparedChange::Content>();
  content->members.push_back(std::move(member));
  content->in_place = true;
  content->what = what_of("core.swap", {std::string(component)});
  if (Status sound = rewired(system.architecture, *content).check(); !sound) return sound.error();
  return make_prepared(system.architecture, std::move(content));
}

std::shared_ptr<Ongoing> begin_in_place_park(System& system, PreparedChange& change) {
  PreparedMember& member = change.content().members.front();
  // A component that the operator had stopped, or that had faulted, keeps its state.
  const ComponentState state = state_of(system, *member.component);
  const bool runs = state == ComponentState::running || state == ComponentState::recovering;
  member.resume = runs || (member.restores && state == ComponentState::faulted);
  PreparedMember step = member_of(*member.component, runs ? Mode::park : Mode::keep);
  step.keeps_fault = true;
  step.base = step.next = member.base;  // else a rollback came between: nothing is parked
  // The core that runs is cleaned up: nothing may roll back meanwhile.
  for (auto& note : notes_of(system, change.content())) {
    change.content().warnings.push_back(std::move(note));
  }
  return begin_mode(system, std::move(step), true);
}

Status in_place_exchange(System& system, PreparedChange& change) {
  const PreparedMember& member = change.content().members.front();
  const bool occupied = somebody_is_inside(system, member);
  if (occupied && !member.restores) return still_inside(member);
  const Elements old = elements_of(*member.base, *member.next);
  const Inside inside;
  if (!inside)
    return refuse({Errc::timed_out, "preparation_abandoned"}, member.component->name(),
                  "was dropped before: its thread was abandoned");
  // A rollback leaves a core in use as it is: that core is cleaned up when its job has returned.
  Status configured = occupied ? ok() : cleanup_in_reverse(old);
  if (!abandoned_here()) configured = configure(elements_of(*member.next, *member.base));
  // When the thread was abandoned, the component stays parked, without its old core.
  if (configured || abandoned_here() || member.restores) return configured;
  if (Status back = configure(old); !back) {
    configured.error().message +=
        "; and the old core could not be configured again: " + back.error().message;
    configured.error().code = Errc::wrong_state;
    configured.error().id = "core_lost_in_place";
  }
  return configured;
}

Result<std::shared_ptr<Ongoing>> begin_in_place_resume(System& system, PreparedChange& change,
                                                       const Status& exchanged) {
  PreparedMember& member = change.content().members.front();
  if (!member.restores && state_of(system, *member.component) == ComponentState::faulted) {
    member.resume = false;  // it failed before it was parked
  }
  member.resume = member.resume && system.may_run(member.component->name());
  const Mode mode = member.resume ? Mode::run : Mode::keep;
  if (!exchanged) {
    const bool old_is_usable = member.component->bundle()->core->configured();
    if (!old_is_usable || member.restores) return exchanged.error();  // never back to what failed
    PreparedMember step = member_of(*member.component, mode);
    step.count_gap = member.resume;
    return begin_mode(system, std::move(step));
  }
  member.mode = mode;
  member.count_gap = member.resume;
  return std::shared_ptr<Ongoing>(begin_commit(system, change));
}

}  // namespace mauve::exec
