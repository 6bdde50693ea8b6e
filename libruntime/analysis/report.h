// SPDX-License-Identifier: LGPL-3.0-or-later
/// Report: the findings of the analysis. They are facts only; the caller decides on the
/// consequences.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/task_set.h"
#include "mauve/result.h"

namespace mauve::analysis {

/// No bound was found.
inline constexpr Duration kUnbounded = Duration::max();

/// One kind of job of a task.
struct JobReport {
  Vertex job;
  Duration response{0};    ///< from release to end, at most; may be kUnbounded
  Duration deadline{0};    ///< never later than the next release
  Duration separation{0};  ///< until the next release, at least
  /// Only of a job that may be late: the longest execution time with which the job meets its
  /// deadline. No execution time suffices when it is 0 or less: the tasks above take all the time.
  Duration needed_execution{0};

  [[nodiscard]] bool late() const { return response > deadline; }
  /// Time left before the deadline.
  [[nodiscard]] Duration slack() const {
    return late() && response == kUnbounded ? Duration::min() : deadline - response;
  }
  /// Only of a job that may be late: the deadline that it would meet; 0 when that is beyond its
  /// next release.
  [[nodiscard]] Duration needed_deadline() const {
    return response <= separation ? response : Duration{0};
  }
};

struct TaskReport {
  std::string name;
  std::optional<int> cpu;  ///< none: it floats, and no response was computed
  int priority = 0;
  Presence presence = Presence::always;
  Source source = Source::declared;  ///< the weakest of its jobs
  Duration blocking{0};              ///< by lower tasks that hold a resource, at most
  /// Resources that may add to the blocking, since their holding times are unknown.
  std::vector<std::string> guessed;
  std::vector<JobReport> jobs;

  [[nodiscard]] bool late() const;
  /// The job with the least slack; null when there is none.
  [[nodiscard]] const JobReport* tightest() const;
};

struct CpuReport {
  int cpu = 0;
  double load = 0;             ///< long-term share that its tasks and its kernel may ask for
  Duration busiest_second{0};  ///< the time that they may request in any second, at most
  bool overloaded = false;     ///< more than kSecondLimit of it
};

/// The kernel stops real-time threads that take more than this of a second.
inline constexpr Duration kSecondLimit = 950ms;

/// A resource with a lock whose users are on different processors, or float.
struct SharedReport {
  std::string resource;
  std::vector<std::string> tasks;
};

struct Report {
  std::vector<TaskReport> tasks;  ///< by CPU, then highest priority first; those that float last
  std::vector<CpuReport> cpus;
  std::vector<SharedReport> cross_cpu;

  /// Every job meets its deadline and no CPU is overloaded, as far as it could be computed.
  [[nodiscard]] bool passes() const;
  /// passes(), and nothing is unknown, floats or is shared across CPUs.
  [[nodiscard]] bool proven() const;
};

/// Why a report is not proven().
struct Problem {
  enum class Kind : std::uint8_t {
    late,        ///< a job may miss its deadline
    overloaded,  ///< a CPU
    unknown,     ///< an execution time
    floating,    ///< a task is not pinned to one CPU
    cross_cpu,   ///< a lock is shared across CPUs
  };
  Kind kind = Kind::late;
  /// Names the task, its job and the time that the job needs. The hint gives the values with which
  /// this task alone would pass.
  Error error;
  std::string aside;  ///< the end of the hint: another remedy
};

/// A little less, in the three digits that messages show.
[[nodiscard]] Duration rounded_down(Duration value);

/// Every problem, one for each task and kind; empty when proven().
[[nodiscard]] std::vector<Problem> problems(const Report& report);

}  // namespace mauve::analysis
