// SPDX-License-Identifier: LGPL-3.0-or-later
/// FaultReaction: the reaction of a task to a core that fails, or that does not prove itself on
/// probation. When a core throws, crashes or hangs, its safe values are written before the fault is
/// recorded, except in park_for_good(). [rt], and park_for_good() is [guard].
#pragma once

#include <array>
#include <cstdint>

namespace mauve {

namespace rt {
struct Fault;
}

namespace exec {

enum class Cause : std::uint8_t;
struct JobUse;
struct TaskContext;

class FaultReaction {
 public:
  explicit FaultReaction(TaskContext& task) : task_(task) {}

  /// Records that the core has failed. The task waits for its rollback or another core, or parks.
  /// The caller has written the safe values, and the details into the text of the record.
  void fail(Cause cause);
  /// fail() for a job that ran longer than its bound; it writes the details itself.
  void fail_as_hung();
  /// Writes the details of user code that crashed, that ran too long, or that threw this.
  Cause describe(const rt::Fault& fault, bool hung, const std::array<char, 128>& thrown);
  /// fail() for a converter that did not end in order; it writes the safe values and the details
  /// itself. The new core is in force, with a state that may be half written.
  void fail_in_hand_over(const rt::Fault& fault);
  /// Counts the release of a failed core as missed, or parks the task if nothing can recover it.
  void pass_release();
  /// Judges a job on probation that did not fail. Implausible values, or enough evidence that the
  /// core takes too long, trigger the rollback.
  void check_on_probation(const JobUse& job);
  /// Triggers the rollback of the change, if the task is on probation.
  void trigger_rollback();
  /// After too many late jobs: `on_overrun` stop parks the task with its safe values written, and
  /// fallback lets the standby core take over at the next release.
  void react_to_overruns();
  /// Records that no thread is left for the task, and parks it as faulted. [guard] must not run
  /// code of a plugin, so [control] writes the safe values.
  void park_for_good(const char* why);
  /// Writes the safe values of the connected ports. [guard] interrupts a service that does not
  /// return, as it interrupts a job, but never abandons the thread for it.
  void write_safe_values();

  /// Is the task on probation, with a rollback that is triggered or still can be?
  [[nodiscard]] bool may_roll_back() const;
  /// Is the task on probation, and does a failure trigger the rollback?
  [[nodiscard]] bool judges() const;
  /// A failed core waits while the rollback is under way, or while its policy promises another
  /// core. The standby core exists already, or [control] makes it or declares that there is none.
  [[nodiscard]] bool may_recover() const;

 private:
  [[nodiscard]] bool awaits_rollback() const;
  void describe_hang();
  void record(Cause cause);
  void report(Cause cause);
  void log_fault(Cause cause);

  TaskContext& task_;
};

}  // namespace exec
}  // namespace mauve
