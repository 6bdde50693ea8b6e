// SPDX-License-Identifier: LGPL-3.0-or-later
/// Direct stop: parks components when [control] is held up. Of the model it uses only the list of
/// tasks, under its lock. Each task writes its safe values and parks by itself (Task::halt), and
/// the guard ends a job that does not end. An ordinary stop does the books when [control] goes on.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "exec/system/system.h"

#include <mauve/host/ongoing.h>

namespace mauve::exec {

/// See Deployer::begin_direct_stop(). Of all components, those that write safe values park first,
/// and the others get one more job to act on that. [any]
[[nodiscard]] std::unique_ptr<DirectStop> begin_direct_stop(System& system,
                                                            std::vector<std::string> components);
/// No components: all. [control]
void end_direct_stop(System& system, const std::vector<std::string>& components);

}  // namespace mauve::exec
