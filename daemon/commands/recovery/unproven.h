// SPDX-License-Identifier: LGPL-3.0-or-later
/// New code that a start, or a reload without a probation, put in force: no failure rolls it back.
/// After a crash, mauved starts its generation only when it ran for a while, or a user confirmed
/// it.
#pragma once

#include "commands/command.h"
#include "mauve/host/report.h"

namespace mauve::daemon {

/// [control] This change is in force; the generation it made is unconfirmed from now on.
/// `changed`: its components, marked before it was in force.
void begin_unproven(Running& running, Call& call, std::vector<FailureMark> changed);

/// [main], before [control] runs: the generation that the run begins with is unconfirmed.
/// `replaces`: a copy of it that goes when it is confirmed (0: none). `crashes`: of the runs
/// before.
void begin_start(Running& running, std::uint64_t replaces, unsigned crashes);

/// [control] A request stopped or started a component, which made this generation. The probation of
/// the generation before it goes on; when it ends well, both are confirmed.
void carry_unproven(Running& running, std::uint64_t generation);

/// [control] Confirms it when none of its components failed for as long as a probation lasts. Later
/// generations are confirmed by their own rules.
void look_at_unproven(Running& running);

/// [control] By hand. False: the generation in force is none of these.
[[nodiscard]] bool confirm_unproven(Running& running);

/// [control] The saved generation that runs is unconfirmed.
[[nodiscard]] bool is_saved_unconfirmed(const Running& running);

/// [control] The end of a probation, or a standby core that took over: which generations this
/// proves, and marks them.
void account_proofs(Running& running, const Outcome& outcome);

/// [control] Of the generation that a rollback made, after account_proofs().
[[nodiscard]] Confirmation mark_of_rollback(Running& running, const Outcome& outcome);

/// [control] Confirms the generation that runs when all changes in it are proven, in whatever order
/// others were undone.
void confirm_proven(Running& running);

}  // namespace mauve::daemon
