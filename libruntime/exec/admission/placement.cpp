// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/admission/placement.h"

#include <algorithm>
#include <map>

#include "rt/thread/thread.h"

#include <mauve/host/component.h>
#include <mauve/host/shared_data.h>
#include <mauve/service.h>

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

/// The first resource in both; null: none.
ResourceBase* common(const std::set<ResourceBase*>& a, const std::set<ResourceBase*>& b) {
  for (ResourceBase* lock : a) {
    const bool shared =
        std::any_of(b.begin(), b.end(), [&](const ResourceBase* other) { return other == lock; });
    if (shared) return lock;
  }
  return nullptr;
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

Placement::Placement(const System& system) {
  for (const Deployed& one : system.deployed) {
    auto locks = locks_of(*one.component->bundle()->bindings);
    all_.push_back(locks);
    if (one.cpus.empty()) continue;
    placed_.push_back({one.component->name(), std::move(locks), one.cpus});
  }
}

/// These locks, those of every task that shares one of them, and so on.
std::set<ResourceBase*> Placement::linked_by(std::set<ResourceBase*> locks) const {
  for (std::size_t before = 0; before != locks.size();) {
    before = locks.size();
    for (const auto& others : all_) {
      if (common(locks, others) != nullptr) locks.insert(others.begin(), others.end());
    }
  }
  return locks;
}

int Placement::least_used() const {
  std::map<int, int> load;
  for (const int cpu : rt::usable_cpus()) load[cpu] = 0;
  for (const Placed& one : placed_) {
    for (const int cpu : one.cpus) ++load[cpu];
  }
  const auto least = std::min_element(
      load.begin(), load.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return least->first;
}

Placement::Seat Placement::seat(const std::string& name, const Bundle& bundle) {
  Placed mine{name, locks_of(*bundle.bindings), bundle.task.cpus};
  Seat seat{mine.cpus, ""};
  if (seat.cpus.empty()) seat.why = "its task names no cpus";
  const auto linked = linked_by(mine.locks);
  for (const Placed& other : placed_) {
    ResourceBase* const lock = common(linked, other.locks);
    if (!seat.cpus.empty() || lock == nullptr || other.cpus.size() != 1) continue;
    seat.cpus = other.cpus;
    const bool itself = mine.locks.contains(lock);
    seat.why += itself ? ", and it shares the lock of " + lock->name() + " with " + other.name
                       : ", and locks link it with " + other.name;
  }
  if (seat.cpus.empty()) seat.cpus = {least_used()};
  mine.cpus = seat.cpus;
  placed_.push_back(std::move(mine));
  return seat;
}

void place(System& system, Deployed& deployed) {
  if (!deployed.cpus.empty()) return;
  const std::string& name = deployed.component->name();
  const Placement::Seat seat = Placement(system).seat(name, *deployed.component->bundle());
  deployed.cpus = seat.cpus;
  if (seat.why.empty() || system.options.simulated) return;
  system.warnings.push_back(name + " is pinned to CPU " + std::to_string(deployed.cpus.front()) +
                            ": " + seat.why);
}

}  // namespace mauve::exec
