// SPDX-License-Identifier: LGPL-3.0-or-later
/// Step 1 of a change: everything slow, and everything that can fail, beside the running system.
#pragma once

#include <mauve/host/prepared_change.h>
#include <mauve/result.h>

namespace mauve {
struct Change;
}  // namespace mauve

namespace mauve::exec {

class System;

/// prepare(): see Deployer. `configure` false: elements are made, not configured (in place).
Result<PreparedChange> prepare_change(System& system, const Change& change, bool configure = true);

}  // namespace mauve::exec
