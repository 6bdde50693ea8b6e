// SPDX-License-Identifier: LGPL-3.0-or-later
/// Orderly end in bounded time: who writes safe values stops before who reads them.
#include <algorithm>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "exec/system.h"
#include "model/left_behind.h"

namespace mauve::exec {
namespace {

using Resources = std::set<const ResourceBase*>;

Resources reached(const ComponentBase& component, bool by_safe_writes) {
  Resources resources;
  for (const PortBase* port : component.shell().ports()) {
    const auto& binding = (*component.bundle()->bindings)[port->index()];
    if (binding == nullptr) continue;
    const bool wanted =
        by_safe_writes ? port->has_safe_value() : port->signature().kind == PortKind::read;
    if (wanted) resources.insert(&binding->service().resource());
  }
  return resources;
}

bool shares(const Resources& a, const Resources& b) {
  return std::any_of(a.begin(), a.end(), [&](const auto* item) { return b.count(item) != 0; });
}

/// Stage of each component: later than all whose safe values it reads. Loops are cut at the number
/// of components.
std::map<const Deployed*, std::size_t> stages(const std::vector<Deployed>& deployed) {
  std::vector<std::pair<const Deployed*, Resources>> writers;
  std::vector<std::pair<const Deployed*, Resources>> readers;
  for (const Deployed& one : deployed) {
    Resources written = reached(*one.component, true);
    Resources read = reached(*one.component, false);
    if (!written.empty()) writers.emplace_back(&one, std::move(written));
    if (!read.empty()) readers.emplace_back(&one, std::move(read));
  }
  std::map<const Deployed*, std::size_t> stage;
  for (bool changed = true; changed;) {
    changed = false;
    for (const auto& [writer, written] : writers) {
      for (const auto& [reader, read] : readers) {
        const std::size_t after = std::min(stage[writer] + 1, deployed.size());
        if (reader == writer || stage[reader] >= after || !shares(written, read)) continue;
        stage[reader] = after;
        changed = true;
      }
    }
  }
  return stage;
}

/// Parks the task and waits; false when it does not come to a boundary.
bool park(System& system, Deployed& deployed, Instant deadline) {
  if (deployed.state() != ComponentState::running) return true;
  PreparedChange change = only_mode(*deployed.component, Mode::park);
  Retired nothing;
  const Duration bound{std::max<Instant>(deadline - system.runner->now(), 1'000'000)};
  return commit_change(system, change, nothing, bound).has_value();
}

/// Its thread is stuck in user code: the outputs get their safe values from here.
void write_safe_values(const ComponentBase& component) {
  for (const PortBase* port : component.shell().ports()) {
    const auto& binding = (*component.bundle()->bindings)[port->index()];
    if (binding != nullptr) port->write_safe(binding->service());
  }
}

/// Longer than this nobody waits for a slow reader's next job.
constexpr Duration kNearRelease = 100ms;
/// A healthy component gets this long to end its job, however late the hour.
constexpr Duration kShortestPatience = 100ms;

/// Running components that will soon read what just stopped get one more job to act on it.
void let_readers_run(System& system, const std::vector<Deployed*>& readers, Instant deadline) {
  const Instant soon = system.runner->now() - system.t0 + kNearRelease.count();
  std::vector<std::uint64_t> before;
  for (const Deployed* reader : readers) before.push_back(reader->task->counters().releases.load());
  static_cast<void>(system.runner->await(
      [&] {
        for (std::size_t i = 0; i < readers.size(); ++i) {
          if (readers[i]->state() == ComponentState::running &&
              readers[i]->task->counters().next_release.load() <= soon &&
              readers[i]->task->counters().releases.load() <= before[i] + 1) {
            return false;
          }
        }
        return true;
      },
      deadline));
}

/// Parks all components, who writes safe values before who reads them. Returns those that hang.
std::set<const Deployed*> park_in_order(System& system, Duration bound) {
  const Instant deadline = system.runner->now() + bound.count();
  const auto stage = stages(system.deployed);
  std::size_t last = 0;
  for (const auto& [deployed, number] : stage) last = std::max(last, number);
  const auto stage_of = [&](const Deployed& deployed) {
    const auto found = stage.find(&deployed);
    return found == stage.end() ? std::size_t{0} : found->second;
  };
  const auto patience = [&] {
    return std::min(deadline, system.runner->now() + bound.count() / 4);
  };
  std::set<const Deployed*> hung;
  for (std::size_t number = 0; number <= last; ++number) {
    std::vector<Deployed*> later;
    for (Deployed& deployed : system.deployed) {
      if (stage_of(deployed) > number) later.push_back(&deployed);
      const Instant shortest = system.runner->now() + kShortestPatience.count();
      if (stage_of(deployed) != number) continue;
      if (park(system, deployed, std::max(patience(), shortest))) continue;
      hung.insert(&deployed);
      write_safe_values(*deployed.component);
    }
    if (!later.empty()) let_readers_run(system, later, patience());
  }
  return hung;
}

}  // namespace

std::vector<std::string> bring_down(System& system, Duration bound) {
  std::vector<std::string> left_behind;
  if (!system.up) return left_behind;
  system.up = false;
  const Instant deadline = system.runner->now() + bound.count();
  const std::set<const Deployed*> hung = park_in_order(system, bound);
  for (Deployed& deployed : system.deployed) {
    const bool stuck = hung.count(&deployed) != 0;
    const Instant until = stuck ? system.runner->now() : deadline;
    if (system.runner->end(*deployed.task, until)) continue;
    left_behind.push_back(deployed.component->name());
    deployed.component->abandon();
    leave_behind(std::shared_ptr<Task>(std::move(deployed.task)));  // its thread still runs in it
  }
  return left_behind;
}

Result<Receipt> stop_all(System& system, Duration bound) {
  Receipt receipt;
  for (const Deployed& deployed : system.deployed) {
    if (deployed.state() == ComponentState::running) {
      receipt.components.push_back({deployed.component->name(), Duration{0}, 0, 0});
    }
  }
  if (!receipt.components.empty()) receipt.state = ChangeState::applied;
  std::string hanging;
  for (const Deployed* deployed : park_in_order(system, bound)) {
    hanging += (hanging.empty() ? "" : ", ") + deployed->component->name();
  }
  if (!hanging.empty()) {
    return refuse(
        Errc::timed_out, hanging,
        "did not end its job in time; its safe values are written, all others are stopped",
        "a core that never returns can only be left behind: restart the daemon");
  }
  receipt.generation = system.generation;
  receipt.commit = Duration{system.runner->now() - system.t0};
  receipt.attempts = 1;
  return receipt;
}

}  // namespace mauve::exec
