// SPDX-License-Identifier: LGPL-3.0-or-later
/// Processor: response times of the tasks on one CPU, under SCHED_FIFO.
///
/// The response of a job is the least w that satisfies this equation:
///   `w = wake-up + its work + blocking + work of all tasks of its priority or above in w
///       + interrupts and ticks in w`.
/// The earlier jobs of the task need no term: they ended before the release of this job. A task of
/// equal priority counts as a higher one; first in, first out does not do worse than that. The
/// wake-up is part of the window, like blocking: while it lasts, other jobs are released.
#pragma once

#include <string_view>
#include <vector>

#include "analysis/demand.h"
#include "analysis/report.h"

namespace mauve::analysis {

class Processor {
 public:
  /// The options of the analysis. `factor` multiplies all execution times. `in_turn`: a task that
  /// exists only before a change and one that exists only after it never run together. Else they
  /// do, which is quicker to compute.
  struct Options {
    double factor = 1;
    bool in_turn = false;
  };

  /// `tasks`: those pinned to this CPU, and those that float, since they may delay the pinned ones.
  /// They outlive this object.
  Processor(std::vector<const Task*> tasks, const Overheads& overheads, Options options);

  /// Every job meets its deadline and no second is overloaded; stops at the first that does not.
  [[nodiscard]] bool passes();
  /// One for each pinned task, highest priority first.
  [[nodiscard]] std::vector<TaskReport> tasks();
  /// All but the number of the CPU.
  [[nodiscard]] CpuReport second() const;

 private:
  [[nodiscard]] Cover whole_line() const;
  void find_blocking();
  void name_guessed(std::string_view resource, const std::vector<std::size_t>& level);
  void unroll();
  [[nodiscard]] std::int64_t response(const Demand& demand, std::size_t vertex,
                                      const Interference& others) const;
  [[nodiscard]] std::int64_t needed_execution(const Demand& demand, std::size_t vertex,
                                              const Interference& others) const;
  [[nodiscard]] TaskReport report(const Demand& demand, const Interference& others) const;
  /// The part of a response that is no work: the wake-up and the blocking.
  [[nodiscard]] std::int64_t delay(const Demand& demand) const {
    return overheads_.wake.count() + demand.blocking;
  }
  /// Calls visit(demand, interference) for each pinned task, highest priority first, until false.
  template <typename Visit>
  bool each(Visit visit);

  const Overheads overheads_;
  const Options options_;
  std::vector<Demand> demands_;  // highest priority first
  Kernel kernel_;
  std::int64_t horizon_ = 0;  // longest window that is computed exactly
};

}  // namespace mauve::analysis
