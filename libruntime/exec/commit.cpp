// SPDX-License-Identifier: LGPL-3.0-or-later
/// Step 2 of a change: one instant for all members; then the books.
#include <algorithm>

#include "exec/swap.h"
#include "exec/system.h"

#include <mauve/job.h>

namespace mauve::exec {
namespace {

void add_hand_over(const PreparedMember& member, Published& next) {
  const Bundle& old = *member.base;
  if (member.next->core == old.core) return;
  StateBase* const from = old.core->state();
  StateBase* const into = member.next->core->state();
  if (member.state == StatePolicy::keep && from != nullptr && into != nullptr &&
      into->fits(*from)) {
    next.from = from;
    next.into = into;
  }
  if (member.next->core_type.name != old.core_type.name) return;
  for (ObservableBase* observable : member.next->core->observables()) {
    const ObservableBase* same = old.core->find_observable(observable->name());
    if (same != nullptr && same_type(same->type(), observable->type())) {
      next.observables.emplace_back(observable, same);
    }
  }
}

/// Where the new machine goes on: in the wait of the same name, or anew when there is none.
void add_state_map(const PreparedMember& member, Published& next) {
  if (member.next->fsm == member.base->fsm) return;
  for (const FsmState* state : member.base->fsm->states()) {
    FsmState* same = member.next->fsm->find_state(state->name());
    next.state_map.push_back(same != nullptr && same->kind() == state->kind() ? same : nullptr);
  }
}

/// Ports that lose their service get their safe value written first.
void add_safe_writes(const PreparedMember& member, Published& next) {
  const Bindings& old = *member.base->bindings;
  for (const PortBase* port : member.base->shell->ports()) {
    const auto& before = old[port->index()];
    if (before == nullptr || !port->has_safe_value()) continue;
    const PortBase* same = member.next->shell->find_port(port->name());
    if (same != nullptr && (*member.next->bindings)[same->index()] == before) continue;
    next.safe_writes.emplace_back(port, &before->service());
  }
}

std::unique_ptr<Published> make_published(const PreparedMember& member) {
  auto next = std::make_unique<Published>();
  next->bundle = member.next;
  next->mode = member.mode;
  next->restart = member.restart;
  next->count_gap = member.count_gap;
  next->grid = member.next->fsm->grid();
  next->shortest_wait = member.next->fsm->shortest_wait();
  add_hand_over(member, *next);
  add_state_map(member, *next);
  add_safe_writes(member, *next);
  return next;
}

Status check_current(const PreparedMember& member) {
  if (member.component->bundle() == member.base) return ok();
  return refuse(Errc::conflict, member.component->name(),
                "was changed by somebody else while this change was prepared", "try again");
}

Error not_applied(const SwapResult& swapped, const std::vector<Member>& members) {
  const std::string names = members.size() == 1 ? members.front().task->name() : "the components";
  switch (swapped.state) {
    case SwapResult::State::missed:
      return refuse(Errc::timed_out, names,
                    "every attempt missed its instant: the machine is overloaded", "try again");
    case SwapResult::State::revoked:
      return refuse(Errc::timed_out, names,
                    "did not end its job within 2 s, so the change was taken back",
                    "look at `status`: a core that never returns holds its component");
    default:
      return refuse(Errc::partly, names,
                    "only some components reached a boundary within 2 s: the change is in force "
                    "on those",
                    "stop the component that hangs");
  }
}

void commit_resource(System& system, PreparedResource& change, Retired& retired) {
  ResourceBase& resource = *change.resource;
  for (const std::string& port : change.disconnect) {
    const PortBase* found = resource.shell().find_port(port);
    const auto binding = resource.bindings()[found->index()];
    {
      Entry entry(resource.gate());
      if (entry) found->write_safe(binding->service());
    }
    static_cast<void>(resource.disconnect(port));
  }
  for (const NewConnection& wanted : change.connect) {
    const Result<ServiceBase*> service = system.architecture.find_service(wanted.service);
    if (!service) continue;
    static_cast<void>(resource.connect(wanted.port, **service, (*service)->resource().keep_alive(),
                                       wanted.max_age));
  }
  if (change.core != nullptr) retired.add(resource.exchange_core(change.core));
}

/// The elements of the old bundle that the new one does not use, in the order of dependency.
void retire(const PreparedMember& member, Retired& retired) {
  if (member.next->shell != member.base->shell) retired.add(member.base->shell);
  if (member.next->core != member.base->core) retired.add(member.base->core);
  if (member.next->fsm != member.base->fsm) retired.add(member.base->fsm);
}

}  // namespace

PreparedChange only_mode(ComponentBase& component, Mode mode) {
  auto content = std::make_unique<PreparedChange::Content>();
  PreparedMember member;
  member.component = &component;
  member.base = component.bundle();
  member.next = component.bundle();
  member.mode = mode;
  content->members.push_back(std::move(member));
  return PreparedChange(std::move(content));
}

Result<Receipt> commit_change(System& system, PreparedChange& change, Retired& retired,
                              Duration longest_job) {
  if (Status outside = refuse_in_job("deployer", "commit()"); !outside) return outside.error();
  PreparedChange::Content& content = change.content();
  std::vector<Member> members;
  std::vector<std::uint64_t> missed_before;
  for (const PreparedMember& member : content.members) {
    if (Status current = check_current(member); !current) return current.error();
    Deployed* deployed = system.find(member.component->name());
    members.push_back({deployed->task.get(), make_published(member), nullptr, nullptr});
    missed_before.push_back(deployed->task->counters().missed.load());
  }
  SwapResult swapped{SwapResult::State::committed, system.runner->now(), 1};
  if (!members.empty()) swapped = swap(members, *system.runner, longest_job);
  const bool nothing_happened =
      swapped.state == SwapResult::State::missed || swapped.state == SwapResult::State::revoked;
  if (nothing_happened) return not_applied(swapped, members);

  Receipt receipt{++system.generation,
                  ChangeState::applied,
                  Duration{swapped.instant - system.t0},
                  swapped.attempts,
                  {}};
  for (std::size_t i = 0; i < members.size(); ++i) {
    const PreparedMember& member = content.members[i];
    if (members[i].in_force == nullptr) continue;
    if (member.next != member.base) member.component->install(member.next);
    if (member.type) member.component->renew(*member.type);
    retire(member, retired);
    receipt.components.push_back({member.component->name(), members[i].in_force->pause,
                                  members[i].task->counters().missed.load() - missed_before[i],
                                  members[i].in_force->bytes});
  }
  content.made.forget();  // in force now
  if (swapped.state == SwapResult::State::partly) return not_applied(swapped, members);
  for (PreparedResource& resource : content.resources) {
    commit_resource(system, resource, retired);
    receipt.components.push_back({resource.resource->name(), Duration{0}, 0, 0});
  }
  return receipt;
}

}  // namespace mauve::exec
