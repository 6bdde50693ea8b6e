// SPDX-License-Identifier: LGPL-3.0-or-later
/// Components that join a running system, and leave it.
#pragma once

#include "exec/system/system.h"

namespace mauve::exec {

/// Makes its task and its thread, parked and not shown to anybody yet. [control]
Result<Deployed*> let_in(System& system, ComponentBase& component);

/// Ends its thread, which is parked and has no change under way. It has no component from then on.
/// False: the thread does not end, and is abandoned. [control]
bool let_go(System& system, Deployed& deployed);

}  // namespace mauve::exec
