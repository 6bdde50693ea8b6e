// SPDX-License-Identifier: LGPL-3.0-or-later
/// Statistics: the times of the jobs of a component, counted all the time by its own thread. They
/// are about the code that runs now: another core, or another state machine, begins anew; a
/// property does not.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <mauve/time.h>

namespace mauve {

/// Many times of one kind. `count`, `sum`, `min` and `max` are exact.
struct Distribution {
  /// Times of `from` and more, below `to`.
  struct Bucket {
    Duration from{0};         ///< included
    Duration to{0};           ///< excluded
    std::uint64_t count = 0;  ///< of times in it
  };
  std::uint64_t count = 0;      ///< of all times
  Duration sum{0};              ///< of all times
  Duration min{0};              ///< the shortest
  Duration max{0};              ///< the longest
  std::vector<Bucket> buckets;  ///< ascending, without empty ones; the last has no end

  [[nodiscard]] Duration mean() const;  ///< zero: no time
  /// At most so many of a hundred are longer: at 99.9 one of a thousand. The middle of a bucket, so
  /// up to 3.2 % (below 64 ns: 2 ns) beside the exact one; 100 is exact.
  [[nodiscard]] Duration percentile(double percent) const;
};

/// Times of which only this much is known.
struct TimeTotal {
  std::uint64_t count = 0;  ///< of times
  Duration sum{0};          ///< of them
  Duration longest{0};      ///< of them
};

/// An execution state. Its time goes on until the next state is chosen.
struct StateStatistics {
  std::string name;        ///< of the state
  Distribution execution;  ///< when the job was not preempted
  TimeTotal preempted;     ///< when it was, with the time of the preempting threads
};

/// Numbers may be some jobs apart.
struct ComponentStatistics {
  std::string name;                     ///< of the component
  std::string core;                     ///< in force
  Duration since{0};                    ///< T0 to the first job that is counted; zero: none yet
  Duration budget{0};                   ///< as declared; zero: none
  std::uint64_t missed = 0;             ///< releases for which no job ran
  std::uint64_t overruns = 0;           ///< jobs that ended after their wait or deadline
  std::uint64_t over_budget = 0;        ///< jobs whose processor time exceeds the budget
  Duration over_budget_max{0};          ///< the most processor time of these
  Distribution lateness;                ///< from a release to the start of its job: of all jobs
  Distribution execution;               ///< of jobs that were not preempted
  Distribution preempted;               ///< of the others, with the time of the preempting threads
  Distribution response;                ///< from a release to the end of its job
  TimeTotal lock_waits;                 ///< for resources that others held
  std::vector<StateStatistics> states;  ///< its execution states
};

}  // namespace mauve
