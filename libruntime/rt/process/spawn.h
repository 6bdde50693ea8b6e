// SPDX-License-Identifier: LGPL-3.0-or-later
/// Starts a program. Not on a real-time thread.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

#include <mauve/result.h>

namespace mauve::rt {

/// `command` (its first word is the path of the program) as a process in a group of its own, with
/// default signals and ordinary scheduling. Its descriptor i is descriptors[i]; it has no others.
/// No page tables are copied, so locked memory costs nothing.
[[nodiscard]] Result<pid_t> spawn(const std::vector<std::string>& command,
                                  const std::vector<int>& descriptors);

}  // namespace mauve::rt
