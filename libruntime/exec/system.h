// SPDX-License-Identifier: LGPL-3.0-or-later
/// System: a deployed architecture; what the deployer's operations work on.
#pragma once

#include <limits>
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
  std::shared_ptr<Task> task;
  std::vector<int> cpus;
  int priority = 0;
  bool realtime = false;
  std::uint64_t lost_events = 0;  ///< reported so far
  bool changing = false;          ///< a change of it is under way: no other may begin
  bool parking = false;           ///< that change is an order to park

  [[nodiscard]] ComponentState state() const { return task->counters().state.load(); }
};

class Commit;

class System {
 public:
  System(Architecture& its_architecture, DeployOptions its_options)
      : architecture(its_architecture),
        options(its_options),
        runner(options.simulated ? make_simulation() : make_threads()) {}

  Architecture& architecture;
  const DeployOptions options;
  std::shared_ptr<Runner> runner;
  std::vector<Deployed> deployed;
  std::vector<std::string> warnings;
  std::vector<std::shared_ptr<Commit>> under_way;
  std::uint64_t generation = 0;
  Instant t0 = 0;
  bool up = false;
  bool realtime = false;

  [[nodiscard]] Deployed* find(std::string_view component);
  /// Takes every change under way as far as it can go now.
  void advance();
  /// The component of this name, or an error with the nearest one.
  Result<ComponentBase*> component(std::string_view name) const;
};

/// deploy(): privileges, threads, T0.
Status bring_up(System& system);
/// shutdown(): see Deployer.
std::vector<std::string> bring_down(System& system, Duration bound);
/// Of one component, when the whole stop should not take much longer than `bound`.
[[nodiscard]] Duration patience_within(Duration bound);
inline constexpr Instant kNever = std::numeric_limits<Instant>::max();

/// prepare(): see Deployer. `configure` false: elements are made, not configured (in place).
Result<PreparedChange> prepare_change(System& system, const Change& change, bool configure = true);
/// A part of a change that leaves everything as it is but for the mode.
[[nodiscard]] PreparedMember member_of(ComponentBase& component, Mode mode);

[[nodiscard]] ComponentStatus look_at(const System& system, const Deployed& deployed);
std::size_t drain_events(System& system, const std::function<void(const Happening&)>& visit);

}  // namespace mauve::exec
