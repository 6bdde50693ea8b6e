// SPDX-License-Identifier: LGPL-3.0-or-later
/// What a shell offers at TAB: commands and options from the table, live names from the daemon.
#pragma once

#include <string>
#include <vector>

namespace mauve::ctl {

/// `words`: the command line after the program, the last one is the one to be completed (it may be
/// empty). A daemon that does not answer within a moment adds nothing, and nothing is said.
[[nodiscard]] std::vector<std::string> completions(const std::vector<std::string>& words);

}  // namespace mauve::ctl
