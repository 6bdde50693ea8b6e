// SPDX-License-Identifier: LGPL-3.0-or-later
/// JobRunner: runs one job of a task, which is code of its core, and accounts for the time that the
/// job took. [rt]
#pragma once

#include <mauve/time.h>

namespace mauve {

class FsmState;
struct Job;

namespace rt {
struct Fault;
}

namespace exec {

class FaultReaction;
struct JobUse;
struct TaskContext;
struct TaskUpdate;

class JobRunner {
 public:
  JobRunner(TaskContext& task, FaultReaction& faults) : task_(task), faults_(faults) {}

  /// Runs the job that is due. False: this thread was abandoned meanwhile, and has no part in the
  /// task any more.
  [[nodiscard]] bool run(Instant now);
  /// Tells a core that runs and has not failed that its component stops; the rules of a job hold.
  /// False: as of run().
  [[nodiscard]] bool let_core_stop();
  /// The same when this update stops it. The task claims the update afterwards: a hang in this code
  /// is a hang of a job, and the update waits for the next thread.
  [[nodiscard]] bool let_core_stop(const TaskUpdate& next);
  /// The first call on a thread that replaces an abandoned one: writes the safe values and records
  /// the fault of the abandoned job.
  void go_on();

 private:
  struct JobEnd;

  void begin(Instant now);
  /// Runs `code`, which is user code of the core, from `now` on. False: as of run(); else `fault`
  /// and `end` have its outcome.
  [[nodiscard]] bool run_watched(void (*code)(void*), JobEnd& end, Instant now, rt::Fault& fault);
  Job& enter_job(Instant start, Instant release);
  void leave_job();
  [[nodiscard]] bool fail_for(Instant start, const JobEnd& end, const rt::Fault& fault);
  void pass_fenced();
  void conclude(Instant start, const JobEnd& end, const rt::Fault& fault);
  [[nodiscard]] FsmState* run_states(JobEnd& job);
  void account(Instant start, const JobEnd& job);
  void count_over_budget(const JobUse& job);
  void count_overrun(const JobUse& job);

  TaskContext& task_;
  FaultReaction& faults_;
};

}  // namespace exec
}  // namespace mauve
