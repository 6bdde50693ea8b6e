// SPDX-License-Identifier: LGPL-3.0-or-later
/// The request bound function: how much work a graph of jobs can ask for in any window of time.
#pragma once

#include <cstdint>
#include <vector>

#include "analysis/graph.h"
#include "analysis/steps.h"

namespace mauve::analysis {

/// The work of each vertex of a graph (ns); of 1 each: jobs are counted instead.
using Costs = std::vector<std::int64_t>;

/// The largest sum of costs over all paths whose releases lie in a half-open window, for windows up
/// to `horizon` (ns). Exact: dominated paths are pruned, no others.
[[nodiscard]] Steps request_bound(const Arcs& arcs, const Costs& costs, std::int64_t horizon);

/// A line above the request bound function: burst + rate * length, for windows of every length.
struct Cover {
  double burst = 0;  ///< ns of work, or jobs
  double rate = 0;   ///< long-term share of the processor, or jobs a ns

  Cover& operator+=(const Cover& other) {
    burst += other.burst;
    rate += other.rate;
    return *this;
  }
  [[nodiscard]] double value(double length) const { return burst + rate * length; }
};

/// The line with the smallest rate: that of the dearest cycle.
[[nodiscard]] Cover cover(const Arcs& arcs, const Costs& costs);

}  // namespace mauve::analysis
