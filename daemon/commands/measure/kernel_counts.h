// SPDX-License-Identifier: LGPL-3.0-or-later
/// The counts of the kernel for the thread of a component. Reading them costs the thread nothing.
#pragma once

#include <string>
#include <vector>

#include "protocol/message.h"
#include "rt/process/process.h"

namespace mauve::daemon {

/// {"minor_faults","major_faults","waits","preemptions"}, since the thread began; null where two
/// threads have the name of this component, of which the kernel knows 15 characters. [control]
[[nodiscard]] protocol::Json kernel_counts(const std::vector<rt::ThreadFacts>& threads,
                                           const std::string& component);

}  // namespace mauve::daemon
