// SPDX-License-Identifier: LGPL-3.0-or-later
/// TaskContext: the state of one task that its boundary, its jobs and its reaction to faults share.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "exec/task/core_failure.h"
#include "exec/task/evidence.h"
#include "exec/task/job_meter.h"
#include "exec/task/job_watch.h"
#include "exec/task/mailbox.h"
#include "exec/task/task_report.h"
#include "rt/guardian/guarded_component.h"
#include "rt/machine/noise.h"

#include <mauve/host/clock.h>
#include <mauve/host/report.h>

namespace mauve {

class CoreBase;
class FsmState;
class ResourceLock;

namespace exec {

struct TaskUpdate;

struct TaskContext {
  TaskContext(std::string name, const Clock& its_clock, std::shared_ptr<const rt::Noise> noise);
  ~TaskContext();
  TaskContext(const TaskContext&) = delete;
  TaskContext& operator=(const TaskContext&) = delete;

  const Clock& clock;
  TaskReport report;
  rt::GuardedComponent outputs;
  Mailbox mailbox;
  JobWatch watch;

  // The owner of the task writes the rest: its thread, or [guard] once that is abandoned. Only
  // `failed` has operations for [control] and for any thread.
  CoreFailure failed;
  TaskUpdate* current = nullptr;             ///< the update in force; owned
  const CoreBase* abandoned_core = nullptr;  ///< an abandoned thread may still be inside
  const ResourceLock* failed_in_lock =
      nullptr;                ///< the lock of the resource in whose service its last job failed
  FsmState* state = nullptr;  ///< the wait the task is in; null: before the initial state
  Instant t0 = 0;
  Instant release = 0;       ///< of the next job: t0 + offset + clock of the component
  Duration wait{0};          ///< that ended, or ends, at `release`
  Instant last_release = 0;  ///< of the job before; 0: none since the last start
  Instant parked_at = 0;
  std::uint64_t number = 0;  ///< of the last change that the task took
  JobMeter meter;
  /// Late jobs of the last 64, at any time; on probation also the use of the budget.
  Evidence evidence;
  bool implausible = false;           ///< its last job wrote a value that a port did not let out
  bool inherits_implausible = false;  ///< the state is of such a core; until a job without one
  bool running = false;
  bool waiting = false;  ///< at a barrier; the task runs again after it

  /// The next job is due at this instant.
  void arm(Instant next) {
    release = next;
    report.counters().next_release.store(release - t0, std::memory_order_relaxed);
  }
  /// Has the time of the next job come?
  [[nodiscard]] bool due() const { return running && clock.now() >= release; }
  /// The task runs no job until it is started again.
  void park(ComponentState as);
  /// Tells the guarded outputs which core is in force, and whether its jobs command them.
  void show_core();
  /// Releases without a job. `planned`: a change lets them pass, no thread was late.
  void miss(std::uint64_t releases, Instant time, bool planned = false);
  /// Touches the cache lines that a swap writes here; those of the mailbox it only requests.
  void touch() const;
};

}  // namespace exec
}  // namespace mauve
