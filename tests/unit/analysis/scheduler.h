// SPDX-License-Identifier: LGPL-3.0-or-later
/// A simulated processor: fixed priorities, preemption, first in first out among equals, priority
/// inheritance with hand-over to the most urgent waiter, timer interrupts, ticks and late wake-ups.
/// Tasks walk their graphs at random and change at random instants. Not simulated: nested sections,
/// more than one processor, the cost of the switches at a lock.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "random_systems.h"

namespace simulated {

using random_systems::Random;
using Time = std::int64_t;
inline constexpr Time kNever = std::numeric_limits<Time>::max();

/// A version of a task: its graph, and for each vertex what the analysis says.
struct Version {
  mauve::analysis::Graph graph;
  std::vector<Time> bound;        ///< of the response
  std::vector<Time> first_bound;  ///< of the response of the job that takes the change
};

struct Section {
  std::size_t resource = 0;
  Time length = 0;
};

struct Task {
  std::string name;
  int priority = 0;
  Time offset = 0;
  Time jitter = 0;
  std::vector<Section> sections;
  /// One, or old, new and old again; one without vertices: it is not there.
  std::vector<Version> versions;
  std::vector<Time> starts;  ///< of each version, the first 0
};

struct Result {
  std::uint64_t jobs = 0;
  std::string violation;  ///< empty: none
  double tightest = 0;    ///< largest response as a share of its bound
};

/// Runs until so many jobs ended, or one was too late. Releases stay on `grid`.
[[nodiscard]] Result run(std::vector<Task> tasks, const mauve::analysis::Overheads& overheads,
                         Time grid, std::uint64_t jobs, Random& random);

}  // namespace simulated
