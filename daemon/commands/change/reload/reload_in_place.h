// SPDX-License-Identifier: LGPL-3.0-or-later
/// plugin.reload with `in_place`, for a core whose device only one core can hold.
#pragma once

#include <string>

#include "commands/change/change.h"

namespace mauve::daemon {

/// [control] The core of one component moves to the new build of its plugin, in place. `change`:
/// see members_of().
void reload_in_place(Running& running, const CallPtr& call, Ticket ticket,
                     const std::string& plugin, Change change);

}  // namespace mauve::daemon
