// SPDX-License-Identifier: LGPL-3.0-or-later
/// The candidates that a shell offers at TAB: commands and options from the table, live names from
/// the daemon.
#pragma once

#include <chrono>
#include <string>
#include <string_view>
#include <vector>

namespace mauve::ctl {

/// A candidate that a shell may put in place of the word. A candidate that ends with '=' or '.' is
/// not complete yet.
struct Candidate {
  std::string word;
  std::string text;  ///< its meaning; empty where the word suffices
};

struct Completion {
  std::vector<Candidate> candidates;  ///< a to z
  bool files = false;                 ///< names of files as well
};

/// `words`: the command line after the program, the last one is the one to be completed (it may be
/// empty). A daemon that does not answer `within` this time adds nothing, without a message.
[[nodiscard]] Completion complete(
    const std::vector<std::string>& words,
    std::chrono::milliseconds within = std::chrono::milliseconds(500));

/// The output of `mauvectl __complete` for the scripts of all shells. It has a line for each
/// candidate, with its text after a tab, and ":files" where the shell must add its own file names.
[[nodiscard]] std::string completion_lines(const Completion& completion);

}  // namespace mauve::ctl
