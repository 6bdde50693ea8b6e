// SPDX-License-Identifier: LGPL-3.0-or-later
/// The status of one component, as counters and books show it.
#pragma once

#include "exec/system/system.h"

#include <mauve/host/report.h>

namespace mauve::exec {

[[nodiscard]] ComponentStatus look_at(const System& system, const Deployed& deployed);

}  // namespace mauve::exec
