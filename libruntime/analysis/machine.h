// SPDX-License-Identifier: LGPL-3.0-or-later
/// Machine: a state machine as plain data, and the graph of jobs it can ask for.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "analysis/graph.h"
#include "mauve/result.h"

namespace mauve::analysis {

/// A clock-based state machine (mauve/fsm.h), without its code.
struct Machine {
  struct State {
    std::string name;
    bool waits = false;     ///< a synchronization state
    Duration wait{0};       ///< synchronization: the shortest that its property allows
    Duration execution{0};  ///< the longest run of its method and guards
    Source source = Source::unknown;
    std::vector<std::size_t> next;  ///< targets of its transitions, and its successor
  };
  std::vector<State> states;
  std::size_t initial = 0;
};

/// A synchronization state; its guards take no time worth counting.
[[nodiscard]] Machine::State waiting(std::string name, Duration wait,
                                     std::vector<std::size_t> next);
/// An execution state; an execution time of source `unknown` counts as 0.
[[nodiscard]] Machine::State running(std::string name, Duration execution, Source source,
                                     std::vector<std::size_t> next);

/// The limits that the architecture sets for all jobs of a component. 0: no limit.
struct JobLimits {
  Duration deadline{0};
  Duration budget{0};  ///< declared execution time of a job; replaces the sum over its states
};

/// The graph of a machine. A vertex stands for each pair of waits of which the second can follow
/// the first through execution states only. Its execution time is the longest such path. [any]
/// Refused: an initial state or a target that does not exist (unknown_name), a wait of zero
/// (invalid_value), execution states that can follow each other for ever (cycle).
[[nodiscard]] Result<Graph> to_graph(const Machine& machine, const JobLimits& limits = {});

}  // namespace mauve::analysis
