// SPDX-License-Identifier: LGPL-3.0-or-later
/// The relaxation that a refusal for deadlines names: a value with which the admission would
/// succeed.
#pragma once

#include <string>
#include <vector>

#include "analysis/relaxation.h"
#include "analysis/report.h"

namespace mauve::exec {

/// The error of a problem, with a hint that holds for the whole set. The hint names a sufficient
/// execution time of one of these tasks, or states that none suffices, and names the task that
/// prevents it. [any]
[[nodiscard]] Error refusal_of(const analysis::Problem& problem, const analysis::TaskSet& set,
                               const std::vector<std::string>& tasks,
                               const analysis::Passes& passes);

}  // namespace mauve::exec
