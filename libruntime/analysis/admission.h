// SPDX-License-Identifier: LGPL-3.0-or-later
/// Admission: may this system run, and may it change into that one? A pure function of its
/// arguments; about a millisecond for hundreds of components. [any]
#pragma once

#include "analysis/report.h"
#include "analysis/task_set.h"

namespace mauve::analysis {

/// Response times of all jobs, by CPU.
[[nodiscard]] Report analyze(const TaskSet& set);

/// Response times in the old system, in the new one, during the change at any instant and during
/// the rollback at any later one. So a rollback needs no admission of its own.
[[nodiscard]] Report admit(const TaskSet& before, const TaskSet& after);

/// The largest factor, in steps of about 1 %, by which all execution times could be multiplied so
/// that analyze() still passes; 0 when none does, at most kLargestFactor. Takes some thirty times
/// as long.
[[nodiscard]] double largest_factor(const TaskSet& set);

inline constexpr double kLargestFactor = 1024;

}  // namespace mauve::analysis
