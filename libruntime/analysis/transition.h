// SPDX-License-Identifier: LGPL-3.0-or-later
/// The demand of a system while it changes: old, then new, and old again after a rollback.
#pragma once

#include "analysis/graph.h"
#include "analysis/task_set.h"

namespace mauve::analysis {

/// The jobs of a component that is changed at any instant and perhaps rolled back at any later one.
/// The wait that is under way at a change is kept. The job after it belongs to the new version: it
/// starts in the state of the same name, or is the first job when no such state exists. It takes
/// `change` longer.
[[nodiscard]] Graph transition(const Graph& before, const Graph& after, Duration change);

/// One task set for the change from `before` to `after`: changed tasks with their transitions,
/// those removed and added marked so. A task on another CPU or priority is removed and added.
/// Overheads are those of `after`.
[[nodiscard]] TaskSet transition(const TaskSet& before, const TaskSet& after);

}  // namespace mauve::analysis
