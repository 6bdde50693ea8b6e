// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/system/books.h"

#include "base/thread_role.h"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "exec/system/prepared.h"
#include "model/element/hand_over.h"
#include "model/element/state_transfer.h"

#include <mauve/host/architecture.h>
#include <mauve/host/change.h>
#include <mauve/host/receipt.h>

namespace mauve::exec {

bool stays_stopped(const System& system, const PreparedChange::Content& change,
                   const PreparedMember& member) {
  MAUVE_ON_THREAD(control);
  return member.mode == Mode::run && !change.ends_stops &&
         !system.may_run(member.component->name());
}

void take_back_stops(System& system, const PreparedChange::Content& change) {
  MAUVE_ON_THREAD(control);
  for (const std::string& name : change.newly_stopped) system.stops.start(name, change.last_stop);
  system.obey_stops();
}

Error being_rolled_back(std::uint64_t generation) {
  return refuse({Errc::conflict, "rollback_under_way"}, "generation " + std::to_string(generation),
                "is being rolled back", "try again when it is over: see the log");
}

void retire(const Bundle& old, const Bundle& now, Retired& retired) {
  if (now.shell != old.shell) retired.add(old.shell);
  if (now.core != old.core) retired.add(old.core);
  if (now.fsm != old.fsm) retired.add(old.fsm);
}

void schedule(System& system, Deployed& deployed) {
  MAUVE_ON_THREAD(control);
  const TaskAttributes& task = deployed.component->bundle()->task;
  const bool moves = !task.cpus.empty() && task.cpus != deployed.cpus;
  if (!moves && task.priority == deployed.priority) return;
  if (moves) deployed.cpus = task.cpus;
  deployed.priority = task.priority;
  // Both were found possible when the change was prepared.
  static_cast<void>(system.runner->reschedule(*deployed.task, system.realtime ? task.priority : 0,
                                              deployed.cpus));
  deployed.scheduled = system.runner->now();
  deployed.realtime = system.realtime && system.runner->is_fifo(*deployed.task, task.priority);
}

void say_states(const CoreBase& from, const CoreBase& into, StatePolicy policy,
                MemberReceipt& row) {
  const auto plan = plan_hand_over(from, into, policy);
  if (plan && plan->convert != nullptr) {
    row.converted =
        from.declared_state()->type().name + " -> " + into.declared_state()->type().name;
  }
  for (const DataType* dropped : dropped_states(from, into, policy)) {
    row.dropped += (row.dropped.empty() ? "" : " and ") + dropped->name;
    row.dropped_bytes += dropped->size;
  }
  row.begins_anew = &from != &into && into.declared_stateless() && row.dropped.empty();
}

void note_unexamined(const std::string& at, const CoreBase& from, const CoreBase& into,
                     StatePolicy policy, std::vector<std::string>& notes) {
  for (const DataType* type : unexamined_states(from, into, policy)) {
    notes.push_back(
        at + ": the state " + type->name + " (" + std::to_string(type->size) +
        " B) is kept as it is. Its description, or that of a part of it, has no "
        "fields, so only its name and size were compared; --state drop would start it fresh");
  }
}

void note_fresh(const std::string& at, const CoreBase& from, const CoreBase& into,
                StatePolicy policy, std::vector<std::string>& notes) {
  if (&from == &into || policy == StatePolicy::drop || declares_state(from)) return;
  notes.push_back(at +
                  ": the new core begins fresh, since the core before declares neither a state to "
                  "hand over (mauve::State) nor that it has none (mauve::Stateless)");
}

void note_one_way(const std::string& at, const CoreBase& now, const CoreBase& before,
                  StatePolicy policy, std::vector<std::string>& notes) {
  if (&now != &before && policy != StatePolicy::drop && !declares_state(before)) {
    notes.push_back(
        at +
        ": a rollback returns to the values that the core before had at the change, since "
        "it declares no state; its outputs may jump");
  }
  if (before.declared_state() == nullptr || plan_hand_over(now, before, policy)) return;
  notes.push_back(at + ": a rollback continues with the state from before the change (" +
                  before.declared_state()->type().name + "): its core has no converter from " +
                  now.declared_state()->type().name + ", so its outputs may jump");
}

void note_replaced(const ResourceBase& from, const ResourceBase& into, StatePolicy policy,
                   std::vector<std::string>& notes) {
  const auto plan = plan_transfer(from, into, policy, true);
  if (!plan || (plan->hand_over.from == nullptr && plan->from == nullptr)) return;
  notes.push_back(from.name() +
                  ": a rollback brings the replaced resource back with its data from before the "
                  "change, so outputs may jump");
}

void say_replaced(const ResourceBase& from, const ResourceBase& into, StatePolicy policy,
                  MemberReceipt& row) {
  say_states(from.core(), into.core(), policy, row);
  const auto plan = plan_transfer(from, into, policy, true);
  if (!plan || plan->from == nullptr) return;
  const DataType& old = plan->from->data();
  if (!same_type(old, plan->into->data())) {
    row.converted = old.name + " -> " + plan->into->data().name;
  }
}

void exchange_fallbacks(Architecture& architecture, std::vector<NewFallback>& fallbacks) {
  for (NewFallback& other : fallbacks) {
    ComponentBase* component = architecture.find_component(other.component);
    if (component == nullptr) continue;
    auto before = component->fallback();
    component->fall_back_to(std::exchange(other.fallback, std::move(before)));
  }
}

}  // namespace mauve::exec
