// SPDX-License-Identifier: LGPL-3.0-or-later
/// architecture.apply and architecture.diff: a whole file against the running system.
#pragma once

#include <optional>
#include <string>

#include "arch/compare/describe.h"
#include "arch/text/problem.h"
#include "commands/command.h"

namespace mauve::daemon {

/// [control] Makes the running system that of `text` in one change, or refuses that; takes over the
/// call and the ticket. `text` may come from elsewhere than the parameter `text` of the call; its
/// other parameters count as in architecture.apply. If it is of a saved generation, a call without
/// a reason names that one, and the answer names the plugins that ran in another build then.
void apply_architecture(Running& running, const CallPtr& call, Ticket ticket, std::string text,
                        const std::optional<Generation>& saved = std::nullopt);

/// [control] Which components do not run now.
[[nodiscard]] arch::Parked parked_now(const Running& running);

/// [control] The file of this call, with the rights of its caller: code that no admin has let in
/// runs for an admin only.
[[nodiscard]] Question question_of(const Running& running, const Call& call);

}  // namespace mauve::daemon
