// SPDX-License-Identifier: LGPL-3.0-or-later
/// Boundary: the one place where a running component changes, between two of its jobs. Before it
/// everything is old, after it everything is new (paper section 5). [rt]
#pragma once

#include <memory>
#include <vector>

#include "rt/thread/run_guarded.h"

#include <mauve/time.h>

namespace mauve {

struct Bundle;

namespace exec {

class FaultReaction;
class JobRunner;
struct TaskUpdate;
struct TaskContext;

class Boundary {
 public:
  Boundary(TaskContext& task, FaultReaction& faults, JobRunner& jobs)
      : task_(task), faults_(faults), jobs_(jobs) {}

  /// Between jobs, ahead of the armed release: gives an aborted update back. Takes a committed
  /// update or rollback if the release is at or after its instant and not due, or if the task
  /// does not run. Obeys a direct stop. Parks the task if its core failed and nothing can recover
  /// it. False: see cross().
  [[nodiscard]] bool serve();
  /// The boundary before the job that is due. False: this thread was abandoned meanwhile, and has
  /// no part in the task any more.
  [[nodiscard]] bool cross(Instant now);
  /// With `on_overrun` skip only the newest of the releases that passed runs; the grid is kept.
  void drop_missed(Instant now);
  /// Answers the coordinator. An update that serve() took is answered at once. One that cross()
  /// took is answered after the outputs of the job that was due, so that the answer costs them
  /// nothing.
  void acknowledge();
  /// The first call on a thread that replaces one abandoned in a converter: the update is in force.
  void finish_taking();
  /// The bundles that an abandoned thread may still use: it may be between two of them.
  [[nodiscard]] std::vector<std::shared_ptr<const Bundle>> bundles() const;

 private:
  [[nodiscard]] bool is_early(const TaskUpdate& next) const;
  /// Takes the rollback once it was triggered, or the standby core of a core that failed. False:
  /// see cross().
  [[nodiscard]] bool take_over(Instant now);
  /// `begin`: when the job that the change delays would have begun. False: see cross().
  [[nodiscard]] bool take(TaskUpdate& next, Instant begin);
  [[nodiscard]] bool take_early(TaskUpdate& next);
  void record_applied(const TaskUpdate& next, Instant time);
  void touch(const TaskUpdate& next) const;
  [[nodiscard]] bool take_state(TaskUpdate& next);
  void take_rest(TaskUpdate& next);
  void wait_or_resume(TaskUpdate& step);
  Duration skip_gap(Instant until);
  void keep_bundle(TaskUpdate& next) const;
  void put_in_place(TaskUpdate& next);
  void map_state(const TaskUpdate& next);
  void rearm(const TaskUpdate& next, bool was_running);
  void start(const TaskUpdate& next);
  void keep_phase(const TaskUpdate& next);
  void give_back(TaskUpdate& next);
  /// The task stands still from now on, with its safe values written. False: see cross().
  [[nodiscard]] bool stand_still();

  TaskContext& task_;
  FaultReaction& faults_;
  JobRunner& jobs_;
  TaskUpdate* unacknowledged_ = nullptr;  // applied, not yet answered
  TaskUpdate* taking_ = nullptr;          // its converter runs
  rt::Fault hand_over_fault_;             // of the last converter
};

}  // namespace exec
}  // namespace mauve
