// SPDX-License-Identifier: LGPL-3.0-or-later
/// Quarantine: a core that was rolled back is not put in force again until somebody releases it, or
/// its plugin is another build.
#pragma once

#include "commands/command.h"

namespace mauve::daemon {

/// [control] False: it is there already.
bool quarantine(Running& running, const std::string& core, const std::string& reason);

/// [control] Refuses a change that would put a core in force that is in quarantine.
[[nodiscard]] Status check_quarantine(const Running& running, const Change& change);

}  // namespace mauve::daemon
