// SPDX-License-Identifier: LGPL-3.0-or-later
/// Step functions of the length of a time window: how much work is asked for in it, at most.
#pragma once

#include <cstdint>
#include <vector>

namespace mauve::analysis {

/// Windows longer than `at` (ns) hold at least `total` (ns of work, or a number of jobs).
struct Step {
  std::int64_t at = 0;
  std::int64_t total = 0;

  bool operator==(const Step&) const = default;
};

/// A step function: both members of its steps increase; 0 before the first step.
using Steps = std::vector<Step>;

/// The value for a window of `length`: the total of the last step before it.
[[nodiscard]] std::int64_t value(const Steps& steps, std::int64_t length);

/// The sum of step functions.
[[nodiscard]] Steps sum(const std::vector<const Steps*>& parts);

/// `first` up to some instant of the window, `then` from that instant on: the worst instant for
/// each length up to `horizon`.
[[nodiscard]] Steps one_after_the_other(const Steps& first, const Steps& then,
                                        std::int64_t horizon);

/// A sum of step functions that grows: adding and reading take logarithmic time.
class StepSum {
 public:
  /// `times`: of all steps that will be added; in any order, repeated or not.
  explicit StepSum(std::vector<std::int64_t> times);

  void add(const Steps& steps);
  [[nodiscard]] std::int64_t value(std::int64_t length) const;
  [[nodiscard]] const std::vector<std::int64_t>& times() const { return times_; }

 private:
  std::vector<std::int64_t> times_;
  std::vector<std::int64_t> tree_;  // Fenwick tree of the increments, from index 1
};

}  // namespace mauve::analysis
