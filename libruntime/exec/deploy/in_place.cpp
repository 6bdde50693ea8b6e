// SPDX-License-Identifier: LGPL-3.0-or-later
/// Swap in place: the paper's way, for hardware that only one core can hold at a time.
#include <array>

#include "exec/commit/commit.h"

#include "base/thread_role.h"
#include "exec/commit/under_way.h"
#include "exec/prepare/prepare.h"
#include "exec/recovery/inherit.h"
#include "exec/system/report_control.h"
#include "model/element/elements.h"
#include "model/element/hand_over.h"
#include "model/job/abandonable_thread.h"

#include <mauve/detail/job.h>
#include <mauve/fsm.h>
#include <mauve/host/deployer.h>

namespace mauve {
namespace {

Status configure_pair(const Bundle& bundle) {
  const NoPorts no_ports;
  const std::array<Configurable*, 2> order{bundle.core.get(), bundle.fsm.get()};
  return configure_in_order(order);
}

/// A step that leaves everything as it is but for the mode, and makes no generation.
std::shared_ptr<Ongoing> begin_mode(exec::System& system, exec::PreparedMember member,
                                    bool ends_probation = false) {
  auto content = std::make_unique<PreparedChange::Content>();
  const char* const method = member.mode == Mode::park ? "component.stop" : "component.start";
  content->what = exec::what_of(method, {member.component->name()});
  content->in_place = ends_probation;
  content->step = true;
  content->members.push_back(std::move(member));
  PreparedChange change(std::move(content));
  return exec::begin_commit(system, change);
}

}  // namespace

Result<PreparedChange> Deployer::prepare_in_place(const Edit& edit) {
  MAUVE_ON_THREAD(factory);
  return exec::prepare_change(*system_, {{edit}}, false);
}

Result<PreparedChange> Deployer::prepare_back_in_place(std::string_view component,
                                                       std::shared_ptr<const Bundle> before) {
  MAUVE_ON_THREAD(factory);
  const exec::ModelLock::Hold hold(system_->model);
  if (!hold)
    return refuse(Errc::timed_out, "deployer",
                  "the change was dropped before it began, since its thread was abandoned");
  const Result<ComponentBase*> found = system_->component(component);
  if (!found) return found.error();
  exec::PreparedMember member = exec::member_of(**found, Mode::keep);
  member.next = std::move(before);
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
  content->what = exec::what_of("core.swap", {std::string(component)});
  return exec::make_prepared(system_->architecture, std::move(content));
}

std::shared_ptr<Ongoing> Deployer::begin_in_place_park(PreparedChange& change) {
  exec::PreparedMember& member = change.content().members.front();
  // What the operator had stopped, or what had faulted, stays where it is.
  const ComponentState state = status(member.component->name()).state;
  const bool runs = state == ComponentState::running || state == ComponentState::recovering;
  member.resume = runs || (member.restores && state == ComponentState::faulted);
  exec::PreparedMember step = exec::member_of(*member.component, runs ? Mode::park : Mode::keep);
  step.base = step.next = member.base;  // else a rollback came between: nothing is parked
  // The core that runs is cleaned up: nothing may roll back meanwhile.
  for (auto& note : exec::notes_of(*system_, change.content())) {
    change.content().warnings.push_back(std::move(note));
  }
  return begin_mode(*system_, std::move(step), true);
}

Status Deployer::in_place_exchange(PreparedChange& change) {
  const exec::PreparedMember& member = change.content().members.front();
  const std::array<Configurable*, 2> old{member.base->core.get(), member.base->fsm.get()};
  const Inside inside;
  if (!inside)
    return refuse(Errc::timed_out, member.component->name(),
                  "was dropped before: its thread was abandoned");
  Status configured = cleanup_in_reverse(old);
  if (!abandoned_here()) configured = configure_pair(*member.next);
  // When the thread was abandoned, the component stays parked, without its old core.
  if (configured || abandoned_here() || member.restores) return configured;
  if (Status back = configure_pair(*member.base); !back) {
    configured.error().message +=
        "; and the old core could not be configured again: " + back.error().message;
    configured.error().code = Errc::wrong_state;
  }
  return configured;
}

Result<std::shared_ptr<Ongoing>> Deployer::begin_in_place_resume(PreparedChange& change,
                                                                 const Status& exchanged) {
  exec::PreparedMember& member = change.content().members.front();
  if (!member.restores && status(member.component->name()).state == ComponentState::faulted) {
    member.resume = false;  // it failed before it was parked
  }
  const Mode mode = member.resume ? Mode::run : Mode::keep;
  if (!exchanged) {
    const bool old_is_usable = member.component->bundle()->core->configured();
    if (!old_is_usable) return exchanged.error();
    exec::PreparedMember step = exec::member_of(*member.component, mode);
    step.count_gap = member.resume;
    return begin_mode(*system_, std::move(step));
  }
  member.mode = mode;
  member.count_gap = member.resume;
  return begin(change);
}

Result<Receipt> Deployer::swap_core_in_place(const Edit& edit) {
  Result<PreparedChange> change = prepare_in_place(edit);
  if (!change) return change.error();
  const Result<Receipt> parked = wait(*begin_in_place_park(*change));
  if (!parked) return parked.error();
  const Status exchanged = in_place_exchange(*change);
  const Result<std::shared_ptr<Ongoing>> resumed = begin_in_place_resume(*change, exchanged);
  if (!resumed) return resumed.error();
  Result<Receipt> receipt = wait(**resumed);
  if (!exchanged) return exchanged.error();
  return receipt;
}

}  // namespace mauve
