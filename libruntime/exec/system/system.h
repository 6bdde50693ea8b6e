// SPDX-License-Identifier: LGPL-3.0-or-later
/// System: a deployed architecture, on which the deployer's operations work.
#pragma once

#include <atomic>
#include <cstdint>
#include <list>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/mutex.h"
#include "exec/run/runner.h"
#include "exec/system/control_trace.h"
#include "exec/system/model_lock.h"
#include "exec/task/task.h"
#include "exec/update/task_update.h"
#include "rt/thread/crash_handler.h"

#include <mauve/host/deploy_options.h>
#include <mauve/host/prepared_change.h>
#include <mauve/host/report.h>
#include <mauve/host/retired.h>
#include <mauve/host/user_stops.h>
#include <mauve/result.h>

namespace mauve {

class Architecture;
class ComponentBase;
enum class Mode : std::uint8_t;
struct Change;

namespace exec {

struct PreparedMember;

/// The core that takes over when one fails, see standby.h.
struct StandbyCore {
  std::shared_ptr<PreparedChange::Content> content;  ///< null: none
  PreparedMember* member = nullptr;
  std::shared_ptr<const TaskUpdate::Answer> answer;
};

/// One component and the task that runs it.
struct Deployed {
  ComponentBase* component = nullptr;  ///< null: it was let go
  std::shared_ptr<Task> task;
  std::vector<int> cpus;
  int priority = 0;
  Instant scheduled = 0;  ///< since then its thread has this priority and these CPUs
  Instant timed = 0;      ///< since then its bundle is_timed_alike()
  bool realtime = false;
  std::uint64_t lost_events = 0;  ///< reported so far
  std::uint64_t shown = 0;        ///< the change whose bundle the model shows; 0: the first
  bool changing = false;          ///< a change of it is under way: no other may begin
  bool parking = false;           ///< that change is an order to park
  bool ended = false;             ///< no thread looks at its task any more
  bool ran_until_end = false;     ///< shutdown() found it running
  bool hidden = false;            ///< joins with a change under way, or left with one on probation
  StandbyCore standby;
  std::vector<Instant> restarts;  ///< the recent ones

  [[nodiscard]] ComponentState state() const { return task->counters().state.load(); }
};

class Commit;
class ProbationPeriod;

class System {
  UserStops own_stops_;

 public:
  System(Architecture& its_architecture, DeployOptions its_options);
  ~System();

  Architecture& architecture;
  const DeployOptions options;
  std::shared_ptr<Runner> runner;
  UserStops& stops;                ///< [control]
  std::uint64_t stops_obeyed = 0;  ///< their revision that the tasks know
  /// Addresses stay. Changed by [control] under `members`, since [log] goes through it too.
  std::list<Deployed> deployed;
  /// The components that were let go. A holder of this list may still refer to one of them; it is
  /// emptied when there is no holder. [control]
  std::shared_ptr<std::list<Deployed>> departed = std::make_shared<std::list<Deployed>>();
  /// Held while a change is prepared, which reads the model on [factory]. Actions of the system by
  /// itself get into the books afterwards.
  ModelLock model;
  Mutex members;
  std::vector<RuntimeEvent> last_events
      MAUVE_GUARDED_BY(members);  ///< of components that left; under `members`
  std::vector<std::string> warnings;
  std::vector<std::shared_ptr<Commit>> under_way;
  std::weak_ptr<const Commit> last_change;  ///< as long as its maker has it
  std::weak_ptr<const Commit> newest;       ///< which made the newest generation
  unsigned looks_at_newest = 0;             ///< while its maker has not asked for it
  std::vector<std::shared_ptr<ProbationPeriod>> probations;  ///< the oldest first
  std::vector<std::shared_ptr<ProbationPeriod>> fading;      ///< over, but a thread may still look
  Retired retired;                                           ///< of changes that are over
  std::vector<Outcome> outcomes;                             ///< not yet reported
  std::atomic<std::uint64_t> looks{0};  ///< calls of advance(); a stop detects by it that none come
  std::uint64_t generation = 0;
  std::uint64_t stopped = 0;       ///< the newest generation that a stop made
  std::uint64_t before_stops = 0;  ///< the one before it and before the stops right before it
  /// Rises whenever the model shows something else: a change, a rollback, a core that took over.
  std::atomic<std::uint64_t> revision{0};
  std::uint64_t changes = 0;  ///< numbers that changes got since deployment, see TaskUpdate::number
  ControlTrace control_trace;
  std::vector<TraceRecord> last_trace
      MAUVE_GUARDED_BY(members);  ///< of components that left; under `members`
  Instant t0 = 0;
  bool up = false;
  int stands_still = 0;  ///< see Deployer::stand_still()
  bool realtime = false;
  std::unique_ptr<rt::CrashHandler> crash_handler;  ///< while it is up

  [[nodiscard]] Deployed* find(std::string_view component);
  /// Also one that is hidden.
  [[nodiscard]] Deployed* find(const ComponentBase& component);
  /// A rollback may bring back a component of this name, or a change under way brings one.
  [[nodiscard]] bool is_away(std::string_view component) const;
  /// The newest generation that no stop made.
  [[nodiscard]] std::uint64_t generation_before_stops() const {
    return generation == stopped ? before_stops : generation;
  }
  /// Refuses a change whose generation `made_from` is not in force any more; stops do not count.
  [[nodiscard]] Status check_made_from(const std::optional<std::uint64_t>& made_from) const;
  /// No stop by a user stands. [control]
  [[nodiscard]] bool may_run(std::string_view component) const {
    return stops.of(component) == nullptr;
  }
  /// From here on each task knows the stop that stands against it.
  void obey_stops();
  /// Departed elements to which nothing refers any more go to `retired`.
  void forget_departed();
  /// The component of this name, or an error with the nearest one.
  Result<ComponentBase*> component(std::string_view name) const;
};

/// The runner of the tasks of such a deployment: threads, or a simulation.
[[nodiscard]] std::unique_ptr<Runner> make_runner(const DeployOptions& options);
[[nodiscard]] std::shared_ptr<Task> new_task(const System& system, const ComponentBase& component);
Status start_thread(System& system, Deployed& deployed);

}  // namespace exec
}  // namespace mauve
