// SPDX-License-Identifier: LGPL-3.0-or-later
/// Probation: the time after a change in which a failure rolls back to before it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <mauve/time.h>

namespace mauve {

/// After the commit the old bundles stay ready until every member has run `activations` jobs with
/// the new ones, or `time` has passed, whichever is first. A core that fails (it throws, crashes,
/// hangs, writes an implausible value) rolls back to them at the next release. A core that takes
/// over the state of one that wrote implausible values is not blamed for those until it has run a
/// job without one. A core that takes too long rolls back too; that needs several jobs as evidence
/// (exec/task/evidence.h), and the probation goes on for some jobs while a core is under suspicion.
///
/// A change of other components leaves a probation as it is. A newer change of the same components
/// joins it. The time begins anew, and a failure leads all of them back to before the first change,
/// which is the last proven state. A change that also changes resources ends it early instead.
struct Probation {
  std::uint64_t activations = 3000;  ///< rule of three: fails less than once in 1000 at 95 %
  Duration time{10s};                ///< the other end of it
  Duration confirm_within{0};        ///< zero: no confirmation is needed
  /// Late jobs of a member that are tolerated in `window` jobs of it. At least 1: a single late job
  /// is no evidence.
  unsigned misses = 2;
  unsigned window = 64;  ///< at most 64
  /// Only undo() rolls the change back, and no failure does. A rule sets it, since a rollback would
  /// bring back the core that the rule removed. A later change without it ends this probation.
  bool only_undo = false;
};

/// Changes on probation together.
struct OpenProbation {
  std::vector<std::uint64_t> generations;  ///< the generations they made, the oldest first
  std::vector<std::string> components;     ///< that are rolled back when one of them fails
  Duration passed{0};                      ///< since the newest of the changes
  Probation rules;                         ///< of the newest change
  bool rolls_back = false;                 ///< a failure, or undo(), has triggered the rollback
  std::uint64_t jobs_left = 0;             ///< of the member that has run the fewest
  std::vector<std::string> notes = {};     ///< states that the rollback cannot bring back
  std::vector<std::string> removed = {};   ///< components that the rollback brings back
};

}  // namespace mauve
