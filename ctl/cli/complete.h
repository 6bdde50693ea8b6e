// SPDX-License-Identifier: LGPL-3.0-or-later
/// What a shell offers at TAB: commands and options from the table, live names from the daemon.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace mauve::ctl {

/// What a shell may put in place of the word. One that ends with '=' or '.' is not complete yet.
struct Candidate {
  std::string word;
  std::string text;  ///< what it means; empty where the word says it
};

struct Completion {
  std::vector<Candidate> candidates;  ///< a to z
  bool files = false;                 ///< names of files as well
};

/// `words`: the command line after the program, the last one is the one to be completed (it may be
/// empty). A daemon that does not answer within a moment adds nothing, and nothing is said.
[[nodiscard]] Completion complete(const std::vector<std::string>& words);

/// What `mauvectl __complete` prints for the scripts of all shells: a line for each candidate, its
/// text after a tab, and ":files" where the shell shall add its own.
[[nodiscard]] std::string completion_lines(const Completion& completion);

}  // namespace mauve::ctl
