// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/admission/relaxation.h"

#include <algorithm>

#include "analysis/admission.h"
#include "base/duration.h"

namespace mauve::exec {
namespace {

using analysis::Problem;

/// The tasks that miss their deadlines although this task takes no time.
std::string obstacle(const analysis::TaskSet& set, const std::string& task,
                     const std::string& otherwise) {
  const auto least = analysis::with_execution(set, task, analysis::kShortestExecution);
  const auto problems = analysis::problems(analysis::analyze(least));
  return problems.empty() ? otherwise : problems.front().error.at;
}

}  // namespace

Error refusal_of(const Problem& problem, const analysis::TaskSet& set,
                 const std::vector<std::string>& tasks, const analysis::Passes& passes) {
  const bool of_time =
      problem.kind == Problem::Kind::late || problem.kind == Problem::Kind::overloaded;
  if (!of_time || tasks.empty()) return problem.error;
  constexpr std::size_t kMostAsked = 4;
  Error error = problem.error;
  for (std::size_t i = 0; i < std::min(tasks.size(), kMostAsked); ++i) {
    const auto time = analysis::passing_execution(set, tasks[i], passes);
    if (!time) continue;
    error.hint = "an execution time of " + format_duration(*time) + " would pass (" + tasks[i] +
                 ".task.budget)" + problem.aside;
    return error;
  }
  error.hint = "no execution time of " + tasks.front() + " would pass, because of " +
               obstacle(set, tasks.front(), problem.error.at) + problem.aside;
  return error;
}

}  // namespace mauve::exec
