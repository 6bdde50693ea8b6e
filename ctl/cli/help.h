// SPDX-License-Identifier: LGPL-3.0-or-later
/// Help, made from the table of commands.
#pragma once

#include <cstddef>
#include <string>

#include "cli/command.h"

namespace mauve::ctl {

/// All commands, the options of every command and the exit codes, in lines of at most `width`.
[[nodiscard]] std::string help_text(std::size_t width);

/// One command with its arguments and options.
[[nodiscard]] std::string help_text(const Command& command, std::size_t width);

}  // namespace mauve::ctl
