// SPDX-License-Identifier: LGPL-3.0-or-later
#include "analysis/relaxation.h"

#include <algorithm>
#include <utility>

#include "analysis/report.h"

namespace mauve::analysis {
namespace {

/// The execution time of the longest job. A job of unknown time counts with its deadline, the
/// longest time that makes sense.
Duration longest(const TaskSet& set, const std::string& name) {
  Duration longest{0};
  for (const Task& task : set.tasks) {
    if (task.name != name) continue;
    for (const Vertex& job : task.graph.vertices) {
      const bool unknown = job.source == Source::unknown;
      longest = std::max(longest, unknown ? job.deadline : job.execution);
    }
  }
  return longest;
}

}  // namespace

TaskSet with_execution(TaskSet set, const std::string& name, Duration time) {
  for (Task& task : set.tasks) {
    if (task.name != name) continue;
    for (Vertex& job : task.graph.vertices) {
      job.execution = time;
      job.source = Source::declared;
    }
    for (Section& section : task.sections) {
      const bool whole_job = section.source == Source::unknown;
      section.length = whole_job ? time : std::min(section.length, time);
    }
  }
  return set;
}

std::optional<Duration> passing_execution(const TaskSet& set, const std::string& task,
                                          const Passes& passes) {
  const auto with = [&](Duration time) { return passes(with_execution(set, task, time)); };
  constexpr int kSteps = 12;
  Duration low = kShortestExecution;
  Duration high = longest(set, task);
  if (high <= low || !with(low)) return std::nullopt;
  for (int i = 0; i < kSteps; ++i) {
    const Duration middle = low + (high - low) / 2;
    (with(middle) ? low : high) = middle;
  }
  // Less work is rarely worse, so the search hardly ever goes on to the next shorter time.
  for (Duration shown = rounded_down(low); shown > kShortestExecution;
       shown = rounded_down(shown - shown / 16)) {
    if (with(shown)) return shown;
  }
  return kShortestExecution;
}

}  // namespace mauve::analysis
