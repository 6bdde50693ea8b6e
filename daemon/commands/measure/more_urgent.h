// SPDX-License-Identifier: LGPL-3.0-or-later
/// The components that may be the reason why another one is late. [any]
#pragma once

#include <string>
#include <vector>

#include "mauve/host/report.h"

namespace mauve::daemon {

/// The next steps for a component that is late. First come those of its own: its job is too long,
/// or its thread is an ordinary one. Then comes `why` of each component that goes before it on its
/// CPU and exceeded its budget, the most likely one first. If there is none, and its own job is not
/// too long, the step is `why` of one whose longest job leaves too little of a period.
[[nodiscard]] std::vector<std::string> more_urgent_hints(const ComponentStatus& late,
                                                         const std::vector<ComponentStatus>& all);

}  // namespace mauve::daemon
