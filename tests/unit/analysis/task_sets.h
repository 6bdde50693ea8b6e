// SPDX-License-Identifier: LGPL-3.0-or-later
/// Task sets as textbooks have them: periodic tasks on one CPU, and a machine that costs nothing.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "analysis/admission.h"

namespace mauve::analysis {

inline Task task(const std::string& name, int priority, Duration period, Duration execution) {
  Task task;
  task.name = name;
  task.cpu = 0;
  task.priority = priority;
  task.graph = periodic(period, execution);
  return task;
}

inline TaskSet set(std::vector<Task> tasks) { return {std::move(tasks), no_overheads()}; }

}  // namespace mauve::analysis
