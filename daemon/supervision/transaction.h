// SPDX-License-Identifier: LGPL-3.0-or-later
/// A transaction that a rule or a component began takes effect.
#pragma once

#include <string>
#include <vector>

#include "commands/command.h"
#include "rules/supervision.h"

namespace mauve::daemon {

/// False: there is nothing to prove: a late job must not undo a removal by a rule.
[[nodiscard]] bool brings_something_new(const rules::Steps& steps);

/// The first name of each step.
[[nodiscard]] std::vector<std::string> subjects_of(const rules::Steps& steps);

[[nodiscard]] Change change_that_parks(const std::vector<std::string>& components);

/// [control] Makes the change of these steps. A change of the same components that waits for its
/// confirmation gives way: it is rolled back first, since nobody may be there to confirm it.
void begin_transaction(Running& running, const CallPtr& call, const rules::Steps& steps,
                       Ticket ticket);

}  // namespace mauve::daemon
