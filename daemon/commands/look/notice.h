// SPDX-License-Identifier: LGPL-3.0-or-later
/// Noticing that components failed, for `why`.
#pragma once

#include "commands/command.h"

namespace mauve::daemon {

/// [control] Which core each component runs with: it is to blame when it fails, and may be gone
/// before that is known.
void remember_cores(Running& running);

/// [control] Something took over from a core that failed.
void notice(Running& running, const Outcome& outcome);

/// [control] Looks for components that failed, and stand or recover; asks the log about all
/// failures.
void notice_failed(Running& running);

}  // namespace mauve::daemon
