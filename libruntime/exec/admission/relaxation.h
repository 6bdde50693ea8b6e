// SPDX-License-Identifier: LGPL-3.0-or-later
/// What a refusal for deadlines names: with it, exactly as it is told, the same would be admitted.
#pragma once

#include <string>
#include <vector>

#include "analysis/relaxation.h"
#include "analysis/report.h"

namespace mauve::exec {

/// The error of a problem, with a hint that holds for the whole set: an execution time of one of
/// these tasks, or that none of them would do and who prevents it. [any]
[[nodiscard]] Error refusal_of(const analysis::Problem& problem, const analysis::TaskSet& set,
                               const std::vector<std::string>& tasks,
                               const analysis::Passes& passes);

}  // namespace mauve::exec
