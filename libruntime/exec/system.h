// SPDX-License-Identifier: LGPL-3.0-or-later
/// System: a deployed architecture; what the deployer's operations work on.
#pragma once

#include <atomic>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "exec/model_lock.h"
#include "exec/prepared.h"
#include "exec/runner.h"
#include "exec/task.h"
#include "exec/trace.h"
#include "rt/last_words.h"

#include <mauve/deployer.h>

namespace mauve::exec {

/// The core that takes over when one fails, see relief.h.
struct StandingBy {
  std::shared_ptr<PreparedChange::Content> content;  ///< null: none
  PreparedMember* member = nullptr;
  std::shared_ptr<const Published::Answer> answer;
};

/// One component and what runs it.
struct Deployed {
  ComponentBase* component = nullptr;  ///< null: it was let go
  std::shared_ptr<Task> task;
  std::vector<int> cpus;
  int priority = 0;
  bool realtime = false;
  std::uint64_t lost_events = 0;  ///< reported so far
  std::uint64_t shown = 0;        ///< the change whose bundle the model shows; 0: the first
  bool changing = false;          ///< a change of it is under way: no other may begin
  bool parking = false;           ///< that change is an order to park
  bool ended = false;             ///< no thread looks at its task any more
  bool hidden = false;            ///< joins with a change under way, or left with one on probation
  StandingBy relief;
  std::vector<Instant> restarts;  ///< the recent ones

  [[nodiscard]] ComponentState state() const { return task->counters().state.load(); }
};

class Commit;
class OnProbation;

class System {
 public:
  System(Architecture& its_architecture, DeployOptions its_options);
  ~System();

  Architecture& architecture;
  const DeployOptions options;
  std::shared_ptr<Runner> runner;
  /// Addresses stay. Changed by [control] under `members`, since [log] goes through it too.
  std::list<Deployed> deployed;
  /// Let go. Whoever may still know one holds this; emptied when nobody does. [control]
  std::shared_ptr<std::list<Deployed>> departed = std::make_shared<std::list<Deployed>>();
  /// Held while a change is prepared, which reads the model on [factory]: what the system did by
  /// itself gets into the books afterwards.
  ModelLock model;
  std::mutex members;
  std::vector<Happening> last_events;  ///< of components that left; under `members`
  std::vector<std::string> warnings;
  std::vector<std::shared_ptr<Commit>> under_way;
  std::weak_ptr<const Commit> last_transaction;          ///< as long as its maker has it
  std::weak_ptr<const Commit> newest;                    ///< which made the newest generation
  unsigned looks_at_newest = 0;                          ///< while its maker has not asked for it
  std::vector<std::unique_ptr<OnProbation>> probations;  ///< the oldest first
  std::vector<std::unique_ptr<OnProbation>> fading;      ///< over, but a thread may still look
  Retired free;                                          ///< of changes that are over
  std::vector<Outcome> outcomes;                         ///< not yet told
  std::atomic<std::uint64_t> looks{0};  ///< calls of advance(); a stop can tell that none come
  std::uint64_t generation = 0;
  /// Rises whenever the model shows something else: a change, a rollback, a core that took over.
  std::atomic<std::uint64_t> revision{0};
  std::uint64_t changes = 0;  ///< numbers that changes got since deployment, see Published::number
  ControlTrace control_trace;
  std::vector<TraceRecord> last_trace;  ///< of components that left; under `members`
  Instant t0 = 0;
  bool up = false;
  int stands_still = 0;  ///< see Deployer::stand_still()
  bool realtime = false;
  std::unique_ptr<rt::LastWords> last_words;  ///< while it is up

  [[nodiscard]] Deployed* find(std::string_view component);
  /// Also one that is hidden.
  [[nodiscard]] Deployed* find(const ComponentBase& component);
  /// Takes every change under way as far as it can go now.
  void advance();
  /// The open one that has this way back, or that leads back by it; null: it is over.
  [[nodiscard]] OnProbation* probation_of(const WayBack& way_back) const;
  /// Tasks go back, or are back already, to bundles that the model does not show yet.
  [[nodiscard]] bool is_led_back() const;
  /// What is over is kept until no thread looks at it any more.
  void let_fade();
  /// Probations and reliefs: may change the model.
  void look_after_itself();
  /// The maker of the last transaction has not asked for its result yet.
  [[nodiscard]] bool is_untold() const;
  /// The maker of the newest generation is going to look at it: for some looks `next` makes no
  /// other one. The parts of a stop do not wait for each other. [control]
  [[nodiscard]] bool leaves_newest_in_place(const Commit& next);
  /// What nobody knows any more goes to `free`.
  void forget_departed();
  /// The component of this name, or an error with the nearest one.
  Result<ComponentBase*> component(std::string_view name) const;
};

/// deploy(): privileges, threads, T0.
Status bring_up(System& system);
/// shutdown(): see Deployer.
std::vector<std::string> bring_down(System& system, Duration bound);
/// Of one component, when the whole stop should not take much longer than `bound`.
[[nodiscard]] Duration patience_within(Duration bound);

/// A job that runs longer never returns.
[[nodiscard]] Duration bound_of(const Bundle& bundle);
[[nodiscard]] std::unique_ptr<Published> first_bundle(const ComponentBase& component, Mode mode);
[[nodiscard]] std::shared_ptr<Task> new_task(const System& system, const ComponentBase& component);
Status start_thread(System& system, Deployed& deployed);
/// Its thread has ended: what it still had to say is told with the next drain_events().
void keep_last_events(System& system, Deployed& deployed);

/// prepare(): see Deployer. `configure` false: elements are made, not configured (in place).
Result<PreparedChange> prepare_change(System& system, const Change& change, bool configure = true);
/// A part of a change that leaves everything as it is but for the mode.
[[nodiscard]] PreparedMember member_of(ComponentBase& component, Mode mode);

[[nodiscard]] ComponentStatus look_at(const System& system, const Deployed& deployed);
[[nodiscard]] Incident incident_of(const System& system, const FaultRecord& record);
[[nodiscard]] std::string_view name_of(rt::EventKind kind);
std::size_t drain_events(System& system, const std::function<void(const Happening&)>& visit);

}  // namespace mauve::exec
