// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/swap/bystanders.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <set>
#include <vector>

#include "base/mutex.h"
#include "exec/swap/rewired.h"
#include "exec/system/system.h"

#include <mauve/detail/port_base.h>
#include <mauve/fsm.h>
#include <mauve/host/architecture.h>
#include <mauve/host/component.h>
#include <mauve/host/resource.h>
#include <mauve/service.h>
#include <mauve/shell.h>

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
  const Duration measured{deployed.task->counters().elapsed_max.load(std::memory_order_relaxed)};
  return std::max(measured, deployed.component->bundle()->task.budget);
}

}  // namespace

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

/// No component waits longer than the longest job of the others and the time that the coordinator
/// needs to act.
std::vector<PreparedBarrier::Wait> waits_of(System& system,
                                            const PreparedChange::Content& content) {
  constexpr Duration kCoordinator = 400us;
  const auto bystanders = bystanders_of(system, content);
  std::vector<const Deployed*> waiting;
  Duration gap = kCoordinator;
  const MutexLock lock(system.members);
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

}  // namespace mauve::exec
