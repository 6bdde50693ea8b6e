// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/system/make_update.h"

#include <algorithm>
#include <memory>

#include "exec/system/resource_parts.h"
#include "exec/task/safe_values.h"
#include "exec/update/prefetch_set.h"

#include <mauve/fsm.h>
#include <mauve/host/component.h>
#include <mauve/host/resource.h>
#include <mauve/observable.h>
#include <mauve/service.h>

namespace mauve::exec {
namespace {

void add_hand_over(const PreparedMember& member, TaskUpdate& next) {
  const Bundle& old = *member.base;
  if (member.next->core == old.core) return;
  // Refused only on the rollback to a core that cannot take the state of a later one: it goes on
  // from the value it had. On the way forth prepare() has asked.
  if (const auto plan = plan_hand_over(*old.core, *member.next->core, member.state)) {
    next.hand_over = *plan;
  }
  // Until its first job a core shows the last observables of the one before it, so that no rule
  // fires by a swap.
  for (ObservableBase* observable : member.next->core->observables()) {
    const ObservableBase* same = old.core->find_observable(observable->name());
    if (same != nullptr && same_type(same->type(), observable->type())) {
      next.observables.emplace_back(observable, same);
    }
  }
}

/// Where the new machine goes on: in the wait of the same name, or anew when there is none.
void add_state_map(const PreparedMember& member, TaskUpdate& next) {
  if (member.next->fsm == member.base->fsm) return;
  for (const FsmState* state : member.base->fsm->states()) {
    FsmState* same = member.next->fsm->find_state(state->name());
    next.state_map.push_back(same != nullptr && same->kind() == state->kind() ? same : nullptr);
  }
}

/// Ports that lose their service get their safe value written first.
void add_safe_writes(const PreparedMember& member, TaskUpdate& next) {
  const Bindings& old = *member.base->bindings;
  for (const PortBase* port : member.base->shell->ports()) {
    const auto& before = old[port->index()];
    if (before == nullptr || !port->has_safe_value()) continue;
    const PortBase* same = member.next->shell->find_port(port->name());
    const auto after = same != nullptr ? (*member.next->bindings)[same->index()] : nullptr;
    if (after == before || goes_on_at_replacement(*before, after.get())) continue;
    next.safe_writes.emplace_back(port, before.get());
  }
}

}  // namespace

Duration bound_of(const Bundle& bundle) {
  // Virtual machines hold healthy threads up for tens of milliseconds; the guard excuses these, and
  // a device that a job commands must be safe within 100 ms. After 950 ms of a second the
  // kernel stops all real-time threads of a CPU for the rest of it (sched_rt_runtime_us). That
  // includes more urgent threads, so a job that loops must end long before, beside others that use
  // half of the CPU.
  constexpr Duration kShortest = 75ms;
  constexpr std::int64_t kTimes = 5;
  constexpr Duration kLongest = 400ms;
  const TaskAttributes& task = bundle.task;
  if (task.watchdog > Duration{0}) return task.watchdog;
  if (task.budget > Duration{0}) {
    return std::clamp(kTimes * task.budget, kShortest, std::max(kLongest, 2 * task.budget));
  }
  Duration longest{0};
  for (const FsmState* state : bundle.fsm->states()) longest = std::max(longest, state->duration());
  // A component without a declared budget may use nearly a whole wait of a second.
  return std::clamp(kTimes * longest, kShortest, std::clamp(longest, kLongest, 2 * kLongest));
}

std::unique_ptr<TaskUpdate> first_bundle(const ComponentBase& component, Mode mode) {
  auto first = std::make_unique<TaskUpdate>();
  first->bundle = component.bundle();
  first->prefetch_set = std::make_shared<const PrefetchSet>(*first->bundle);
  first->bound = bound_of(*component.bundle());
  first->has_safe_values = has_safe_values(*component.bundle());
  first->grid = component.fsm().grid();
  first->shortest_wait = component.fsm().shortest_wait();
  first->mode = mode;
  return first;
}

std::unique_ptr<TaskUpdate> make_update(const PreparedMember& member) {
  auto next = std::make_unique<TaskUpdate>();
  next->bundle = member.next;
  next->prefetch_set = std::make_shared<const PrefetchSet>(*member.next);
  next->mode = member.mode;
  next->ends_stop = member.ends_stop;
  next->mode_only = member.next == member.base && member.part != Part::joins;
  next->ends_fault =
      member.mode == Mode::park && member.part == Part::changes && !member.keeps_fault;
  next->restart = member.restart;
  next->count_gap = member.count_gap;
  next->bound = bound_of(*member.next);
  next->has_safe_values = has_safe_values(*member.next);
  next->grid = member.next->fsm->grid();
  next->shortest_wait = member.next->fsm->shortest_wait();
  next->other_core = is_other_code(*member.base->core, *member.next->core);
  next->offset_changes = member.next->task.offset != member.base->task.offset;
  add_hand_over(member, *next);
  add_state_map(member, *next);
  add_safe_writes(member, *next);
  return next;
}

Origin origin_of(const PreparedMember& member, bool was_running) {
  Origin origin{member.base, Mode::keep, member.state};
  const bool runs_after = member.mode == Mode::run || (was_running && member.mode == Mode::keep);
  if (runs_after != was_running) origin.mode = was_running ? Mode::run : Mode::park;
  return origin;
}

std::unique_ptr<TaskUpdate> make_rollback(const PreparedMember& member, const Origin& origin) {
  PreparedMember reversed;
  reversed.component = member.component;
  reversed.base = member.next;
  reversed.next = origin.bundle;
  reversed.state = origin.state;
  reversed.mode = origin.mode;
  reversed.restart = reversed.mode == Mode::run;
  auto back = make_update(reversed);
  if (origin.state_kept != nullptr && back->hand_over.from == nullptr) {
    const auto kept =
        plan_hand_over(*origin.state_kept->core, *origin.bundle->core, StatePolicy::keep);
    if (kept) back->hand_over = *kept;
  }
  back->applied_as = AppliedAs::back;
  return back;
}

}  // namespace mauve::exec
