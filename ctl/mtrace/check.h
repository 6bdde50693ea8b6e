// SPDX-License-Identifier: LGPL-3.0-or-later
/// Does a trace obey the model? Releases on the logical clock, none lost, states as the machine has
/// them, urgent before less urgent, changes at one cut, responses within the admitted bounds.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mtrace/trace.h"

namespace mauve::ctl::mtrace {

struct Violation {
  std::string
      rule;  ///< one word: "release", "lost", "wait", "state", "lock", "order", "cut", "response"
  std::string thread;
  std::int64_t time = 0;
  std::uint32_t line = 0;
  std::string message;
  std::string hint;
};

/// How much of each kind was looked at.
struct Checked {
  std::uint64_t components = 0;
  std::uint64_t releases = 0;  ///< on the instant that was announced
  std::uint64_t waits = 0;     ///< that lasted as their state requires
  std::uint64_t states = 0;
  std::uint64_t orders = 0;  ///< pairs of jobs on one processor
  std::uint64_t changes = 0;
  std::uint64_t takes = 0;      ///< of a change by a component, at its instant
  std::uint64_t missed = 0;     ///< releases for which no job ran, as the trace records them
  std::uint64_t responses = 0;  ///< against the admitted bound
  std::map<std::string, std::uint64_t> responses_of;  ///< of these, by component
  std::map<std::string, std::uint64_t> over_budget;   ///< jobs, by component
};

struct Verdict {
  std::optional<Violation> first;                 ///< violation, by time
  std::uint64_t found = 0;                        ///< all of them
  std::map<std::string, std::uint64_t> found_of;  ///< of these, by rule
  Checked checked;
  std::vector<std::string> not_checked;  ///< the rules, and why; a sentence each

  [[nodiscard]] bool holds() const { return found == 0; }
};

[[nodiscard]] Verdict check(const Trace& trace);

}  // namespace mauve::ctl::mtrace
