// SPDX-License-Identifier: LGPL-3.0-or-later
/// The command line, read with the table of commands.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "cli/command.h"
#include "protocol/message.h"

namespace mauve::ctl {

struct Invocation {
  const Command* command = nullptr;
  Arguments arguments;
  Globals globals;
};

/// Help or version were asked: print the text and end with 0.
struct Text {
  std::string text;
};

struct Misuse {
  protocol::Fault fault;
  bool json = false;
  std::string colour = "auto";
};

/// `words` is the command line without the program; help is at most `width` columns wide.
[[nodiscard]] std::variant<Invocation, Text, Misuse> parse_options(
    const std::vector<std::string>& words, std::size_t width = 80);

/// Options before or after any command, with a text each; completion offers them as well.
[[nodiscard]] std::span<const Argument> global_options();

/// The meanings of the exit codes, for help and manual.
struct ExitCode {
  int code = 0;
  std::string_view word;  ///< "refused"
  std::string_view text;  ///< one sentence
};
[[nodiscard]] std::span<const ExitCode> exit_codes();

}  // namespace mauve::ctl
