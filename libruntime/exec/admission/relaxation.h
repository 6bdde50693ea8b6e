// SPDX-License-Identifier: LGPL-3.0-or-later
/// Relaxation in a refusal for deadlines: with the value that the message shows, the same would
/// pass.
#pragma once

#include <string>
#include <vector>

#include "analysis/relaxation.h"
#include "analysis/report.h"

namespace mauve::exec {

/// The error of a problem, with a hint that holds for the whole set. The hint names a sufficient
/// execution time of one of these tasks, or says that none suffices and which task prevents it.
/// [any]
[[nodiscard]] Error refusal_of(const analysis::Problem& problem, const analysis::TaskSet& set,
                               const std::vector<std::string>& tasks,
                               const analysis::Passes& passes);

}  // namespace mauve::exec
