// SPDX-License-Identifier: LGPL-3.0-or-later
/// Evidence: does a core on probation take longer than it may? A single job proves nothing: a
/// machine that stands still makes any job long or late, and its host charges part of the stolen
/// time to the thread that ran. A job also proves nothing when a probe shows that the machine was
/// held up for as long as the job exceeds its limit.
#pragma once

#include <bit>
#include <cstdint>
#include <optional>

#include <mauve/time.h>

namespace mauve::exec {

/// When one job ran.
struct JobUse {
  Instant released = 0;
  Instant start = 0;
  Instant end = 0;
  Duration late{0};              ///< after its deadline; zero: in time
  std::optional<Duration> used;  ///< processor time; none: it is not known
};

/// How one job of the core ended.
struct JobTiming {
  bool over_budget = false;  ///< it used more processor time than its budget
  bool twice_over = false;   ///< it used more than two budgets
  bool late = false;         ///< it ended after its deadline
  bool too_long = false;     ///< late, and by its own doing: it ran, or slept, for too long
};

/// Owned by the thread of a task. Constant memory, some instructions a job. [rt]
class Evidence {
 public:
  /// A core that exceeds its budget in every job is detected at this one.
  static constexpr int kJobs = 16;
  /// A job over the budget weighs as much as so many jobs within the budget.
  static constexpr int kWeight = 2;
  /// In a sum of its own a job that uses two budgets weighs as much as so many within the budget.
  /// With a larger weight, a host that takes much time from one of five jobs would be evidence.
  static constexpr int kDoubleWeight = 3;
  /// So many such jobs in succession are a verdict. A host was seen to hit 13 jobs in 1.5 s.
  static constexpr int kDoubleJobs = 48;
  /// Of 64 jobs, 8 late ones are excused, since others may have kept them from the processor. These
  /// add to the tolerated ones and to those of kMostAsBefore; with more, the change starves the
  /// core.
  static constexpr unsigned kExcusedOf64 = 8;
  /// Also excused: twice the late jobs before the change, at most so many.
  static constexpr unsigned kMostAsBefore = 24;

  enum class Verdict : std::uint8_t { none, over_budget, overruns };
  struct Rules {
    unsigned tolerated = 2;        ///< late jobs by the core's own doing; 0 counts as 1
    std::uint64_t window = ~0ULL;  ///< among the last jobs: a bit for each
  };

  /// Another core or another change is judged from here on. `proven`: the core before was not on
  /// probation, so its late jobs are evidence about the machine.
  void begin_anew(bool proven) {
    if (proven) late_before_ = late_;
    sum_ = weighted_ = 0;
    too_long_ = late_ = 0;
    forget_overruns();
  }
  /// Counts each job, on probation or not. True when the job is late and at least `limit` of the
  /// last 64 jobs were, for any cause; then it counts anew.
  [[nodiscard]] bool count_late(bool late, unsigned limit) {
    overruns_ = overruns_ << 1U | (late ? 1U : 0U);
    const bool too_often = late && std::popcount(overruns_) >= static_cast<int>(limit);
    if (too_often) forget_overruns();
    return too_often;
  }
  void forget_overruns() { overruns_ = 0; }
  /// A job off probation.
  void note(bool late) { late_ = late_ << 1U | (late ? 1U : 0U); }
  /// A job on probation. Of the budget it is the cumulative sum test of E. S. Page, Continuous
  /// inspection schemes, Biometrika 41 (1954). One sum counts the jobs over the budget; the other
  /// one also weighs by how much, and needs more of them.
  [[nodiscard]] Verdict weigh(const JobTiming& job, const Rules& rules);
  /// There is evidence, not yet enough for a verdict.
  [[nodiscard]] bool suspicious(const Rules& rules) const {
    return sum_ > 0 || weighted_ > 0 || (too_long_ & rules.window) != 0;
  }

 private:
  int sum_ = 0;
  int weighted_ = 0;
  // A bit for each of the last 64 jobs, the newest lowest:
  std::uint64_t too_long_ = 0;     // too long, on probation
  std::uint64_t overruns_ = 0;     // late, since count_late() counts anew
  std::uint64_t late_ = 0;         // late, since the change
  std::uint64_t late_before_ = 0;  // late, before the change
};

}  // namespace mauve::exec
