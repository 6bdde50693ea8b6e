// SPDX-License-Identifier: LGPL-3.0-or-later
/// Who waits at a barrier, and what is handed over there.
#include <algorithm>
#include <set>

#include "exec/barrier.h"
#include "exec/prepare.h"
#include "exec/rewired.h"
#include "model/succession.h"

namespace mauve::exec {
namespace {

using Resources = std::set<const ResourceBase*>;

bool leads_into(const Shell& shell, const Bindings& bindings, const Resources& resources) {
  return std::any_of(shell.ports().begin(), shell.ports().end(), [&](const PortBase* port) {
    const auto& binding = bindings[port->index()];
    return binding != nullptr && resources.contains(&binding->service().resource());
  });
}

bool is_member(const PreparedChange::Content& content, const ComponentBase& component) {
  return std::any_of(content.members.begin(), content.members.end(),
                     [&](const PreparedMember& one) { return one.component == &component; });
}

Duration longest_job(const Deployed& deployed) {
  const Duration measured{deployed.task->counters().execution_max.load(std::memory_order_relaxed)};
  return std::max(measured, deployed.component->bundle()->task.budget);
}

}  // namespace

/// Nobody waits longer than the longest job of the others takes, and the coordinator to act.
std::vector<PreparedBarrier::Wait> waits_of(System& system,
                                            const PreparedChange::Content& content) {
  constexpr Duration kCoordinator = 400us;
  const auto bystanders = bystanders_of(system, content);
  std::vector<const Deployed*> waiting;
  Duration gap = kCoordinator;
  const std::lock_guard lock(system.members);
  for (const Deployed& one : system.deployed) {
    const bool takes_part =
        is_member(content, *one.component) ||
        std::find(bystanders.begin(), bystanders.end(), one.component) != bystanders.end();
    if (!takes_part || one.hidden || one.state() != ComponentState::running) continue;
    waiting.push_back(&one);
    gap = std::max(gap, longest_job(one) + kCoordinator);
  }
  std::vector<PreparedBarrier::Wait> waits;
  for (const Deployed* one : waiting) {
    const std::int64_t grid = one->component->bundle()->fsm->grid().count();
    const std::int64_t releases = grid > 0 ? (gap.count() + grid - 1) / grid : 0;
    waits.push_back({one->component->name(), static_cast<std::uint64_t>(releases)});
  }
  return waits;
}

Status prepare_heir(System& system, const NewResource& joining, PreparedChange::Content& content) {
  const auto& leaving = content.leaving_resources;
  ResourceBase* const from = system.architecture.find_resource(joining.resource->name());
  if (std::find(leaving.begin(), leaving.end(), from) == leaving.end()) return ok();
  ResourceBase& into = *joining.resource;
  if (!into.made()) return into.made();
  const auto plan = plan_succession(*from, into, joining.state, content.probation.has_value());
  if (!plan) return plan.error();
  if (Status slow = prepare_hand_over(from->core(), into.core(), joining.state); !slow) return slow;
  content.barrier->heirs.push_back({from,
                                    {from->shared_core(), from->shared_bindings()},
                                    from->gate().declared_hold(),
                                    &into,
                                    joining.state});
  return ok();
}

std::vector<ComponentBase*> bystanders_of(const System& system,
                                          const PreparedChange::Content& content) {
  const Resources resources = resources_touched(system.architecture, content);
  std::vector<ComponentBase*> bystanders;
  for (ComponentBase* component : system.architecture.components()) {
    if (is_member(content, *component)) continue;
    if (leads_into(component->shell(), *component->bundle()->bindings, resources)) {
      bystanders.push_back(component);
    }
  }
  return bystanders;
}

}  // namespace mauve::exec
