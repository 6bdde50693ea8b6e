// SPDX-License-Identifier: LGPL-3.0-or-later
/// Components that join a running system, and leave it.
#pragma once

#include "exec/system/system.h"

namespace mauve::exec {

/// Makes the task and the thread of a component that joins. The task is parked, and hidden until
/// its change is in force. [control]
Result<Deployed*> let_in(System& system, ComponentBase& component);

/// Ends the thread of a component that leaves: it is parked and has no change under way. `deployed`
/// has no component from then on. False: the thread does not end, and is abandoned. [control]
bool let_go(System& system, Deployed& deployed);

}  // namespace mauve::exec
