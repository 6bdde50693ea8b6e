// SPDX-License-Identifier: LGPL-3.0-or-later
/// The changes of a system that are under way.
#pragma once

#include <memory>

#include "exec/commit/commit.h"
#include "exec/swap/two_phase_commit.h"
#include "exec/system/system.h"

namespace mauve::exec {

/// Begins the commit; each call of advance() takes it further.
std::shared_ptr<Commit> begin_commit(System& system, PreparedChange& change,
                                     TwoPhaseCommit::Kind kind = TwoPhaseCommit::Kind::change,
                                     Duration longest_job = kLongestJob);

/// Takes every change under way as far as it can go now.
void advance(System& system);
/// The maker of the last change has not asked for its result yet.
[[nodiscard]] bool is_unreported(const System& system);
/// Advances probations and standby cores, which may change the model.
void look_after_itself(System& system);

}  // namespace mauve::exec
