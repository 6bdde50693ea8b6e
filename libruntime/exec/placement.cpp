// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/placement.h"

#include <algorithm>
#include <map>

#include "rt/thread.h"

#include <mauve/shared_data.h>

namespace mauve::exec {
namespace {

void collect_locks(const Bindings& bindings, std::set<ResourceBase*>& locks) {
  for (const auto& binding : bindings) {
    if (binding == nullptr) continue;
    ResourceBase& resource = binding->service().resource();
    const bool waits = dynamic_cast<const SharedDataBase*>(&resource) == nullptr;
    if (waits && locks.insert(&resource).second) collect_locks(resource.bindings(), locks);
  }
}

std::set<ResourceBase*> own_locks(const Deployed& deployed) {
  return exec::locks_of(*deployed.component->bundle()->bindings);
}

/// Somebody with a CPU of its own and a lock in common, and that lock.
struct Neighbour {
  const Deployed* deployed = nullptr;
  const ResourceBase* shared = nullptr;
};

Neighbour find_neighbour(const System& system, const Deployed& deployed) {
  const std::set<ResourceBase*> own = own_locks(deployed);
  if (own.empty()) return {};
  for (const Deployed& other : system.deployed) {
    if (&other == &deployed || other.cpus.size() != 1) continue;
    for (const ResourceBase* lock : own_locks(other)) {
      const bool shared = std::any_of(own.begin(), own.end(),
                                      [&](const ResourceBase* mine) { return mine == lock; });
      if (shared) return {&other, lock};
    }
  }
  return {};
}

}  // namespace

std::set<ResourceBase*> locks_of(const Bindings& bindings) {
  std::set<ResourceBase*> locks;
  collect_locks(bindings, locks);
  return locks;
}

Status check_cpus(const TaskAttributes& task, const std::string& component) {
  for (const int cpu : task.cpus) {
    if (Status there = rt::check_cpu(cpu, component + ".task.cpus"); !there) return there;
  }
  return ok();
}

int least_used_cpu(const System& system, const std::vector<int>& more) {
  std::map<int, int> load;
  for (const int cpu : rt::usable_cpus()) load[cpu] = 0;
  for (const Deployed& other : system.deployed) {
    for (const int cpu : other.cpus) ++load[cpu];
  }
  for (const int cpu : more) ++load[cpu];
  const auto least = std::min_element(
      load.begin(), load.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return least->first;
}

void place(System& system, Deployed& deployed) {
  deployed.cpus = deployed.component->bundle()->task.cpus;
  if (!deployed.cpus.empty()) return;
  const Neighbour neighbour = find_neighbour(system, deployed);
  deployed.cpus = {neighbour.deployed != nullptr ? neighbour.deployed->cpus.front()
                                                 : least_used_cpu(system)};
  if (system.options.simulated) return;
  std::string why = ": its task names no cpus";
  if (neighbour.deployed != nullptr) {
    why += ", and it shares the lock of " + neighbour.shared->name() + " with " +
           neighbour.deployed->component->name();
  }
  system.warnings.push_back(deployed.component->name() + " is pinned to CPU " +
                            std::to_string(deployed.cpus.front()) + why);
}

}  // namespace mauve::exec
