// SPDX-License-Identifier: LGPL-3.0-or-later
/// The connections of the whole system as a change, or its way back, would leave them.
#pragma once

#include "exec/system/prepared.h"
#include "model/wiring.h"

namespace mauve::exec {

/// The connections with the change in force. [control], or [factory] with the model locked
[[nodiscard]] Wiring rewired(const Architecture& architecture,
                             const PreparedChange::Content& change);

/// Would an output have two writers with `change` in force, when `before` is rolled back? [control]
[[nodiscard]] bool clash(const Architecture& architecture, const PreparedChange::Content& change,
                         const PreparedChange::Content& before);

}  // namespace mauve::exec
