// SPDX-License-Identifier: LGPL-3.0-or-later
/// The end of an undo, and its refusal when it finds no change on probation.
#pragma once

#include "commands/command.h"

namespace mauve::daemon {

/// [control] The change that made this generation is being rolled back, and some of its components
/// may still run as it left them.
[[nodiscard]] bool is_rolling_back(const Running& running, std::uint64_t generation);

/// [control] Says why nothing can be undone, and the next step. `generation`: the one that the user
/// named; 0: the newest change.
[[nodiscard]] Error nothing_to_undo(const Running& running, std::uint64_t generation);

}  // namespace mauve::daemon
