// SPDX-License-Identifier: LGPL-3.0-or-later
/// A state machine as it is told on the wire.
#pragma once

#include "commands/command.h"
#include "mauve/fsm.h"

namespace mauve::daemon {

/// [control] {"initial","states":[{"name","kind","wait_ns","transitions":[{"to","guarded"}]}]};
/// transitions in the order in which guards are asked, what is taken when none is true last.
[[nodiscard]] Json machine_json(const FsmBase& fsm);

}  // namespace mauve::daemon
