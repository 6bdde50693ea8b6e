// SPDX-License-Identifier: LGPL-3.0-or-later
/// Task: a component at run time. It knows when the next job is due, runs it, and takes changes at
/// its boundaries; its caller is a thread or a simulation.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "exec/task/boundary.h"
#include "exec/task/fault_reaction.h"
#include "exec/task/job_runner.h"
#include "exec/task/task_context.h"

#include <mauve/detail/job.h>
#include <mauve/host/clock.h>
#include <mauve/time.h>

namespace mauve {

struct Bundle;

namespace exec {

struct TaskUpdate;

class Task {
 public:
  /// `noise`: the noise of the machine; null: it is not known.
  Task(std::string name, const Clock& clock, std::shared_ptr<const rt::Noise> noise = nullptr);

  /// Before the first release: the update to run with, and the common T0. [control]
  void begin(std::unique_ptr<TaskUpdate> first, Instant t0);

  [[nodiscard]] const std::string& name() const { return context_.report.name(); }
  [[nodiscard]] const Counters& counters() const { return context_.report.counters(); }
  [[nodiscard]] TaskReport& report() { return context_.report; }
  [[nodiscard]] Mailbox& mailbox() { return context_.mailbox; }
  [[nodiscard]] JobWatch& watch() { return context_.watch; }
  [[nodiscard]] const JobWatch& watch() const { return context_.watch; }
  /// While its core has failed, the task waits for its rollback or its standby core. It parks as
  /// faulted once nothing can recover it.
  [[nodiscard]] CoreFailure& core_failure() { return context_.failed; }
  /// Its guarded outputs, to be asked; stand() also by [control] when no job commands them.
  [[nodiscard]] rt::GuardedComponent& outputs() { return context_.outputs; }
  /// The task runs a core whose last jobs exceeded their budget, without a verdict yet. [any]
  [[nodiscard]] bool suspected() const;

  // --- [guard] ----------------------------------------------------------------------------------
  /// How long its job may run on a real-time or an ordinary thread; at most kHaltedJob during a
  /// direct stop. Zero: without a bound.
  [[nodiscard]] Duration bound(bool realtime) const;
  /// When its next job is due (monotonic); far away: it does not run.
  [[nodiscard]] Instant known_release() const;
  /// Abandons the thread of the task, whose job began at `since` and never returns. The resources
  /// that the thread holds are poisoned, and the caller owns the task until another thread goes on
  /// with it. False: the job has ended, or the thread must keep the task. The thread must not end
  /// meanwhile.
  bool lose_thread(Instant since);
  /// The bundles that the abandoned thread still uses.
  [[nodiscard]] std::vector<std::shared_ptr<const Bundle>> bundles() const;
  /// The caller gave the thread back the priority or the CPUs that its component asked for.
  void count_restored() { add<std::uint64_t>(context_.report.counters().restored, 1); }
  void park_for_good(const char* why) { faults_.park_for_good(why); }  ///< no other thread is left
  /// [control] Was the task parked for good? True once: the caller writes its safe values.
  bool take_safe_values_request() {
    return context_.report.counters().without_thread.exchange(false);
  }
  /// A job may take so long while a direct stop waits for its end.
  static constexpr Duration kHaltedJob = 2s;

  // --- [rt] -------------------------------------------------------------------------------------
  /// Calls Boundary::serve(): the task takes changes and orders ahead of the armed release. False:
  /// this thread was abandoned meanwhile.
  bool serve();
  [[nodiscard]] bool running() const { return context_.running; }
  /// When the next job is due (monotonic); only while running.
  [[nodiscard]] Instant next_release() const { return context_.release; }
  /// Has the time of the next job come?
  [[nodiscard]] bool due() const { return context_.due(); }
  /// Runs the boundary and the job of the armed release. False: this thread was abandoned
  /// meanwhile, and has no part in the task any more.
  bool run_release();
  /// The first call on a thread that replaces an abandoned one: writes the safe values and records
  /// the fault of the abandoned job.
  void go_on();

 private:
  TaskContext context_;
  FaultReaction faults_;
  JobRunner jobs_;
  Boundary boundary_;
};

}  // namespace exec
}  // namespace mauve
