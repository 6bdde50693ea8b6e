// SPDX-License-Identifier: LGPL-3.0-or-later
/// How long tasks of lower priority can hold up a job under priority inheritance (Sha, Rajkumar and
/// Lehoczky, 1990): each lower task once, each resource once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace mauve::analysis {

/// One row for each resource, one column for each task; 0: does not use it.
using Weights = std::vector<std::vector<std::int64_t>>;

/// The largest sum of weights with at most one of each row and of each column. All rows have the
/// same length.
[[nodiscard]] std::int64_t heaviest_matching(const Weights& weights);

/// One task's longest use of a resource.
struct Use {
  std::size_t task = 0;      ///< 0, 1, ...: in order of priority, highest first
  std::size_t resource = 0;  ///< 0, 1, ...
  std::int64_t length = 0;   ///< ns
};

/// For each task the longest blocking by lower tasks of the same processor. `level` of a task:
/// equal for equal priorities, larger for lower ones. The result is exact where few tasks and
/// resources are linked by their uses. For larger groups it is an upper bound: the smaller of two
/// sums, over the longest use of each resource and over the longest use by each task.
[[nodiscard]] std::vector<std::int64_t> blocking(const std::vector<std::size_t>& level,
                                                 const std::vector<Use>& uses);

}  // namespace mauve::analysis
