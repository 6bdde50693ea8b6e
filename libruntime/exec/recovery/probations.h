// SPDX-License-Identifier: LGPL-3.0-or-later
/// The changes on probation of a system.
#pragma once

#include "exec/recovery/probation_period.h"
#include "exec/system/system.h"
#include "exec/update/decision.h"

namespace mauve::exec {

/// The open one that has this rollback, or that rolls back by it; null: it is over.
[[nodiscard]] ProbationPeriod* probation_of(const System& system, const Rollback& rollback);
/// Tasks go back, or are back already, to bundles that the model does not show yet.
[[nodiscard]] bool is_rolled_back(const System& system);
/// Keeps ended probations until no thread looks at them any more.
void let_fade(System& system);

}  // namespace mauve::exec
