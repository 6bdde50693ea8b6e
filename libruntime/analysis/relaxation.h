// SPDX-License-Identifier: LGPL-3.0-or-later
/// Relaxation: the times with which a failing system would pass. [any]
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "analysis/task_set.h"

namespace mauve::analysis {

/// Does this set, as a whole, pass?
using Passes = std::function<bool(const TaskSet&)>;

/// The set with this time, declared, for every job of one task.
[[nodiscard]] TaskSet with_execution(TaskSet set, const std::string& task, Duration time);

/// The longest execution time of one task with which the whole set passes, rounded down to the
/// digits that messages show; none: not even a microsecond passes. Analyses the set some 16 times.
[[nodiscard]] std::optional<Duration> passing_execution(const TaskSet& set, const std::string& task,
                                                        const Passes& passes);

inline constexpr Duration kShortestExecution = 1us;

}  // namespace mauve::analysis
