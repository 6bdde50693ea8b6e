// SPDX-License-Identifier: LGPL-3.0-or-later
/// architecture.apply and architecture.diff: a whole file against the running system.
#pragma once

#include <string>

#include "arch/compare/describe.h"
#include "arch/text/problem.h"
#include "commands/command.h"

namespace mauve::daemon {

/// [control] The running system becomes the one of this text, all of it at one instant, or nothing
/// happens. Takes over the call and the ticket. The text is not `text` of the call when it comes
/// from somewhere else; `dry_run`, `state` and `file` of the call are looked at. A `reason` that is
/// not empty goes to the log in place of a missing one.
void apply_architecture(Running& running, const CallPtr& call, Ticket ticket, std::string text,
                        const std::string& reason);

/// [control] Which components do not run now.
[[nodiscard]] arch::Parked parked_now(const Running& running);

/// [control] The file of this call, with the rights of its caller: code that no admin has let in
/// runs for an admin only.
[[nodiscard]] Question question_of(const Running& running, const Call& call);

}  // namespace mauve::daemon
