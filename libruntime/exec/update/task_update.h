// SPDX-License-Identifier: LGPL-3.0-or-later
/// TaskUpdate: a change as one task takes it.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "exec/update/decision.h"
#include "model/element/hand_over.h"

#include <mauve/host/change_policy.h>
#include <mauve/time.h>

namespace mauve {

class Binding;
class FsmState;
class ObservableBase;
class PortBase;
struct Bundle;

namespace exec {

class PrefetchSet;

/// The reason why a task applied an update, as a trace records it.
enum class AppliedAs : std::uint8_t { change, back, standby, barrier };

/// All that a change hands to one task: the new bundle, and the data that lets the task take it
/// with a few pointer stores. After publication only the side that has claimed it may write it.
struct TaskUpdate {
  /// At a barrier, `wait` suspends the task: it runs no job from the instant on. `resume`, or the
  /// next change, resumes it. The task keeps its bundle, and is not seen to be stopped.
  enum class Barrier : std::uint8_t { none, wait, resume };

  std::shared_ptr<const Bundle> bundle;  ///< null: an update of a barrier
  Decision* decision = nullptr;
  Barrier barrier = Barrier::none;
  AppliedAs applied_as = AppliedAs::change;
  /// Of the change, see System::changes; 0: of a standby core, or of the first bundle of the task.
  std::uint64_t number = 0;
  Mode mode = Mode::keep;
  std::uint64_t ends_stop = 0;  ///< it starts the task unless a newer stop by a user stands
  bool mode_only = false;       ///< the task keeps the bundle that it has, and ignores `bundle`
  bool ends_fault = false;      ///< a stop: from here on a faulted component is stopped
  bool restart = false;         ///< begin at the initial state, on the next instant of the grid
  bool offset_changes = false;
  bool other_core = false;       ///< other code: measured times do not hold for it
  bool has_safe_values = false;  ///< of the bundle, on connected ports
  bool count_gap = false;        ///< releases that passed while parked count as missed (in place)
  Duration grid{0};
  Duration shortest_wait{0};
  Duration bound{0};  ///< a longer job is interrupted, or its thread abandoned; zero: no bound
  std::shared_ptr<const PrefetchSet> prefetch_set;  ///< of the bundle; null: not known
  /// By index of the state of the old machine: the state of the new one; null: begin anew.
  std::vector<FsmState*> state_map;
  HandOver hand_over;
  std::vector<std::pair<ObservableBase*, const ObservableBase*>> observables;
  /// Ports that lose their service: their safe values are written first.
  std::vector<std::pair<const PortBase*, const Binding*>> safe_writes;

  /// On probation: the update to which this one is rolled back when a member fails. Null: no
  /// probation, or this is such an update itself.
  std::unique_ptr<TaskUpdate> back;
  Rollback* rollback = nullptr;         ///< it triggers `back`, or this update; null: neither
  unsigned tolerated = 0;               ///< overruns among the jobs of `window`
  std::uint64_t window = ~0ULL;         ///< a bit for each job that counts
  std::unique_ptr<TaskUpdate> standby;  ///< that stands by from the first job on; or null
  Duration back_off{0};                 ///< a standby core waits so long after the fault

  enum class Progress : std::uint8_t {
    published,
    done,        ///< in force; if it was met at a release, the job of that release has ended
    given_back,  ///< missed its instant, or was superseded: the task never used it
  };
  /// The answer of the task; it outlives the update.
  struct Answer {
    /// The next job begins at most so much later. This and the next three are valid when done.
    Duration pause{0};
    std::size_t bytes = 0;  ///< of the state that was handed over
    bool failed = false;    ///< its state was not converted
    FaultRecord fault;      ///< of a standby core: of the core from which it took over
    /// The task writes this last. Then it reads neither the answer nor the decision any more.
    std::atomic<Progress> progress{Progress::published};
  };
  const std::shared_ptr<Answer> answer = std::make_shared<Answer>();
  TaskUpdate* older = nullptr;  ///< in the list of updates that the task does not use any more
};

}  // namespace exec
}  // namespace mauve
