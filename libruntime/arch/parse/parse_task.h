// SPDX-License-Identifier: LGPL-3.0-or-later
/// The "task" of a component.
#pragma once

#include "arch/parse/spec.h"
#include "arch/text/read.h"

namespace mauve::arch {

/// Reads priority, cpus, offset, deadline, budget, stack, on_overrun, overrun_limit, on_fault
/// and watchdog.
void read_task(const Source& source, TaskSpec& task);

}  // namespace mauve::arch
