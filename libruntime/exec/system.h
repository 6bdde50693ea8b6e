// SPDX-License-Identifier: LGPL-3.0-or-later
/// System: a deployed architecture; what the deployer's operations work on.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "exec/prepared.h"
#include "exec/runner.h"
#include "exec/task.h"

#include <mauve/deployer.h>

namespace mauve::exec {

/// One component and what runs it.
struct Deployed {
  ComponentBase* component = nullptr;
  std::unique_ptr<Task> task;
  std::vector<int> cpus;
  int priority = 0;
  bool realtime = false;
  std::uint64_t lost_events = 0;  ///< reported so far

  [[nodiscard]] ComponentState state() const { return task->counters().state.load(); }
};

class System {
 public:
  System(Architecture& its_architecture, DeployOptions its_options)
      : architecture(its_architecture),
        options(its_options),
        runner(options.simulated ? make_simulation() : make_threads()) {}

  Architecture& architecture;
  const DeployOptions options;
  std::unique_ptr<Runner> runner;
  std::vector<Deployed> deployed;
  std::vector<std::string> warnings;
  std::uint64_t generation = 0;
  Instant t0 = 0;
  bool up = false;
  bool realtime = false;

  [[nodiscard]] Deployed* find(std::string_view component);
  /// The component of this name, or an error with the nearest one.
  Result<ComponentBase*> component(std::string_view name) const;
};

/// deploy(): privileges, threads, T0.
Status bring_up(System& system);
/// shutdown(): see Deployer.
std::vector<std::string> bring_down(System& system, Duration bound);
/// stop_all(): see Deployer.
Result<Receipt> stop_all(System& system, Duration bound);

/// prepare(): see Deployer. `configure` false: elements are made, not configured (in place).
Result<PreparedChange> prepare_change(System& system, const Change& change, bool configure = true);
/// After the decision a member takes its bundle in the wait it is in, or after the job it is in.
inline constexpr Duration kLongestJob = 2s;
/// commit(): see Deployer.
Result<Receipt> commit_change(System& system, PreparedChange& change, Retired& retired,
                              Duration longest_job = kLongestJob);
/// A change that leaves everything as it is but for the mode.
PreparedChange only_mode(ComponentBase& component, Mode mode);

[[nodiscard]] ComponentStatus look_at(const System& system, const Deployed& deployed);
std::size_t drain_events(System& system, const std::function<void(const Happening&)>& visit);

}  // namespace mauve::exec
