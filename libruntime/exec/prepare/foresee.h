// SPDX-License-Identifier: LGPL-3.0-or-later
/// The effects of a prepared change, to be shown before it takes effect.
#pragma once

#include "exec/system/prepared.h"
#include "exec/system/system.h"

#include <mauve/host/receipt.h>

namespace mauve::exec {

/// The receipt that the change would get now, without times. [control]
[[nodiscard]] Receipt foresee(const System& system, const PreparedChange::Content& content);

}  // namespace mauve::exec
