// SPDX-License-Identifier: LGPL-3.0-or-later
/// FaultReaction: the reaction of a task to a core that fails, or that does not prove itself on
/// probation. Safe values are written before the fault is recorded. [rt]
#pragma once

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

  /// The core has failed; the text of the record holds the details, and the safe values are
  /// written. The task waits for another core, or parks.
  void fail(Cause cause);
  /// The job ran into its bound.
  void hang();
  /// The new core is in place, with a state that may be half written.
  void fail_in_hand_over(const rt::Fault& fault);
  /// A failed core runs no more; this release passes, until another core takes over.
  void pass_release();
  /// A job on probation is judged also where it does not fail.
  void judge(const JobUse& job);
  /// On probation: triggers the rollback of the change. The core goes on until its next release.
  void trigger_rollback();
  void overran_too_often();
  /// No thread is left for the task. The guard calls it, which must not run code of a plugin, so
  /// [control] writes the safe values.
  void park_for_good(const char* why);
  /// A service that does not return is ended as a job is.
  void write_safe_values();

  /// Is the task on probation, with a rollback that is triggered or still can be?
  [[nodiscard]] bool may_roll_back() const;
  /// A failed core waits while the rollback is under way, or while its policy promises another
  /// core. The standby core exists already, or [control] makes it or declares that there is none.
  [[nodiscard]] bool may_recover() const;

 private:
  [[nodiscard]] bool awaits_rollback() const;
  void record(Cause cause);
  void report(Cause cause);
  void log_fault(Cause cause);

  TaskContext& task_;
};

}  // namespace exec
}  // namespace mauve
