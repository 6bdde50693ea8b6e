// SPDX-License-Identifier: LGPL-3.0-or-later
/// Statistics of the jobs of a component, as the deployer reports them.
#pragma once

#include "exec/system/system.h"

#include <mauve/host/statistics.h>

namespace mauve::exec {

/// The statistics of the bundle that the model shows. [control]
[[nodiscard]] ComponentStatistics statistics_of(const System& system, const Deployed& deployed);

}  // namespace mauve::exec
