// SPDX-License-Identifier: LGPL-3.0-or-later
/// The demand of tasks and of the kernel on one processor, in numbers.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "analysis/rbf.h"
#include "analysis/task_set.h"

namespace mauve::analysis {

/// A task, ready for computing. All times in ns.
struct Demand {
  /// `factor` multiplies all execution times. The task outlives the demand.
  Demand(const Task& of, const Overheads& overheads, double factor);

  /// Works out `steps` for windows up to `horizon`.
  void unroll(std::int64_t horizon);
  /// The work in any window of `length`, exactly.
  [[nodiscard]] std::int64_t work_within(std::int64_t length) const;

  const Task* task;
  Arcs arcs;
  Costs costs;                            ///< of each vertex, switches included
  std::vector<std::int64_t> separations;  ///< of each vertex, until the next release
  std::vector<std::int64_t> deadlines;    ///< of each vertex, at most the separation
  Cover line;                             ///< of the work, jitter included
  Cover jobs;                             ///< of their number
  Steps steps;                            ///< of the work, jitter included
  std::int64_t blocking = 0;
  std::vector<std::string> guessed;  ///< as in TaskReport
};

/// Interrupts of timers and ticks of the kernel on one processor.
class Kernel {
 public:
  Kernel(const std::vector<Demand>& demands, const Overheads& overheads);

  /// Works out how many timers can expire, where that is less than one at each grid instant.
  void unroll(const std::vector<Demand>& demands, std::int64_t horizon);
  [[nodiscard]] std::int64_t work_within(std::int64_t length) const;
  [[nodiscard]] Cover line() const;

 private:
  const Overheads overheads_;
  std::int64_t grid_ = 0;  // of all releases
  Cover jobs_;
  Steps expiries_;
  std::int64_t counted_ = 0;  // expiries_ holds for windows up to here
};

/// The work that may delay a task. It grows as the view goes down the priorities.
class Interference {
 public:
  /// `in_turn`: a task that exists only before the change and one that exists only after it never
  /// run together. The demands outlive this object.
  Interference(const std::vector<Demand>& demands, const Kernel& kernel, std::int64_t horizon,
               bool in_turn);

  void include(const Demand& demand);
  /// From now on the interference is that which delays this task: its own work is left out.
  void look_from(const Demand& demand);

  [[nodiscard]] std::int64_t work_within(std::int64_t length) const;
  /// A bound for windows beyond the horizon.
  [[nodiscard]] Cover line() const;
  /// The window lengths beyond which more work is requested.
  [[nodiscard]] const std::vector<std::int64_t>& times() const { return together_.times(); }

 private:
  /// Tasks that are there in one phase of the change only.
  struct Phase {
    std::vector<const Demand*> demands;
    [[nodiscard]] Steps steps_without(const Demand* own) const;
    [[nodiscard]] Cover line_without(const Demand* own) const;
  };
  [[nodiscard]] bool phased(const Demand& demand) const {
    return in_turn_ && demand.task->presence != Presence::always;
  }

  const Kernel& kernel_;
  const std::int64_t horizon_;
  const bool in_turn_;
  StepSum together_;
  Cover together_line_;
  Phase before_;
  Phase after_;
  Steps change_;              // the worst of before, after and before again
  bool change_known_ = true;  // change_ is of all demands in the phases
  const Demand* own_ = nullptr;
};

}  // namespace mauve::analysis
