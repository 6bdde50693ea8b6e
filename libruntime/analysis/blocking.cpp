// SPDX-License-Identifier: LGPL-3.0-or-later
#include "analysis/blocking.h"

#include <algorithm>
#include <limits>
#include <map>
#include <numeric>

namespace mauve::analysis {
namespace {

/// More steps than this are not spent on one group and one priority.
constexpr std::size_t kMatchingSteps = 20'000;

Weights transposed(const Weights& weights) {
  Weights result(weights.front().size(), std::vector<std::int64_t>(weights.size()));
  for (std::size_t row = 0; row < weights.size(); ++row) {
    for (std::size_t column = 0; column < result.size(); ++column) {
      result[column][row] = weights[row][column];
    }
  }
  return result;
}

/// Shortest augmenting paths with potentials (Hungarian method); no more rows than columns. Indices
/// from 1: row and column 0 stand for "none".
class Assignment {
 public:
  explicit Assignment(const Weights& weights)
      : weights_(weights),
        row_price_(weights.size() + 1, 0),
        column_price_(weights.front().size() + 1, 0),
        row_of_(column_price_.size(), 0) {
    for (std::size_t row = 1; row <= weights_.size(); ++row) place(row);
  }

  [[nodiscard]] std::int64_t total() const {
    std::int64_t sum = 0;
    for (std::size_t column = 1; column < row_of_.size(); ++column) {
      if (row_of_[column] != 0) sum += weights_[row_of_[column] - 1][column - 1];
    }
    return sum;
  }

 private:
  static constexpr std::int64_t kFar = std::numeric_limits<std::int64_t>::max();

  void place(std::size_t row) {
    std::vector<std::int64_t> distance(row_of_.size(), kFar);
    std::vector<std::size_t> came_from(row_of_.size(), 0);
    std::vector<bool> used(row_of_.size(), false);
    row_of_[0] = row;
    std::size_t column = 0;
    do {
      used[column] = true;
      column = advance(column, distance, came_from, used);
    } while (row_of_[column] != 0);
    while (column != 0) {
      row_of_[column] = row_of_[came_from[column]];
      column = came_from[column];
    }
  }

  /// The nearest column that is not used yet; prices follow.
  std::size_t advance(std::size_t from, std::vector<std::int64_t>& distance,
                      std::vector<std::size_t>& came_from, const std::vector<bool>& used) {
    const std::size_t row = row_of_[from];
    std::size_t nearest = 0;
    std::int64_t delta = kFar;
    for (std::size_t column = 1; column < row_of_.size(); ++column) {
      if (used[column]) continue;
      const std::int64_t cost =
          -weights_[row - 1][column - 1] - row_price_[row] - column_price_[column];
      if (cost < distance[column]) {
        distance[column] = cost;
        came_from[column] = from;
      }
      if (distance[column] < delta) {
        delta = distance[column];
        nearest = column;
      }
    }
    for (std::size_t column = 0; column < row_of_.size(); ++column) {
      if (used[column]) {
        row_price_[row_of_[column]] += delta;
        column_price_[column] -= delta;
      } else if (distance[column] != kFar) {
        distance[column] -= delta;
      }
    }
    return nearest;
  }

  const Weights& weights_;
  std::vector<std::int64_t> row_price_;
  std::vector<std::int64_t> column_price_;
  std::vector<std::size_t> row_of_;
};

/// Tasks and resources that hang together: only within such a group does one choice forbid another.
/// Tasks and resources are numbered anew.
struct Group {
  std::vector<Use> uses;
  std::vector<std::size_t> levels;  ///< of its tasks
  std::size_t resources = 0;
};

class Numbers {
 public:
  std::size_t of(std::size_t name) {
    return numbers_.try_emplace(name, numbers_.size()).first->second;
  }
  [[nodiscard]] std::size_t count() const { return numbers_.size(); }

 private:
  std::map<std::size_t, std::size_t> numbers_;
};

/// Which uses hang together: the same root for all of a group.
std::vector<std::size_t> roots(const std::vector<Use>& uses) {
  std::map<std::size_t, std::size_t> first_of_task;
  std::map<std::size_t, std::size_t> first_of_resource;
  std::vector<std::size_t> parent(uses.size());
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  const auto root = [&](std::size_t use) {
    while (parent[use] != use) use = parent[use] = parent[parent[use]];
    return use;
  };
  for (std::size_t i = 0; i < uses.size(); ++i) {
    parent[root(first_of_task.try_emplace(uses[i].task, i).first->second)] = root(i);
    parent[root(first_of_resource.try_emplace(uses[i].resource, i).first->second)] = root(i);
  }
  for (std::size_t i = 0; i < uses.size(); ++i) parent[i] = root(i);
  return parent;
}

std::vector<Group> grouped(const std::vector<Use>& uses, const std::vector<std::size_t>& level) {
  const std::vector<std::size_t> root = roots(uses);
  Numbers groups;
  std::vector<Group> result;
  std::vector<Numbers> tasks;
  std::vector<Numbers> resources;
  for (std::size_t i = 0; i < uses.size(); ++i) {
    const std::size_t group = groups.of(root[i]);
    result.resize(groups.count());
    tasks.resize(groups.count());
    resources.resize(groups.count());
    const Use use{tasks[group].of(uses[i].task), resources[group].of(uses[i].resource),
                  uses[i].length};
    result[group].uses.push_back(use);
    result[group].levels.resize(tasks[group].count());
    result[group].levels[use.task] = level[uses[i].task];
    result[group].resources = resources[group].count();
  }
  return result;
}

/// The smaller of two simple bounds: each resource at its worst, each task at its worst.
std::int64_t simple_bound(const std::vector<Use>& uses, const Group& group) {
  std::vector<std::int64_t> rows(group.resources, 0);
  std::vector<std::int64_t> columns(group.levels.size(), 0);
  for (const Use& use : uses) {
    rows[use.resource] = std::max(rows[use.resource], use.length);
    columns[use.task] = std::max(columns[use.task], use.length);
  }
  return std::min(std::accumulate(rows.begin(), rows.end(), std::int64_t{0}),
                  std::accumulate(columns.begin(), columns.end(), std::int64_t{0}));
}

/// The longest blocking that the lower tasks of a group can cause to those of `level`.
std::int64_t blocking_by(const Group& group, std::size_t level) {
  std::vector<bool> used_above(group.resources, false);
  for (const Use& use : group.uses) {
    if (group.levels[use.task] <= level) used_above[use.resource] = true;
  }
  std::vector<Use> lower;
  for (const Use& use : group.uses) {
    if (group.levels[use.task] > level && used_above[use.resource]) lower.push_back(use);
  }
  const std::size_t most = lower.size();  // at most so many rows, and columns
  if (most == 0 || most * most * most > kMatchingSteps) return simple_bound(lower, group);
  Numbers rows;
  Numbers columns;
  Weights weights(most, std::vector<std::int64_t>(most, 0));
  for (const Use& use : lower) {
    std::int64_t& weight = weights[rows.of(use.resource)][columns.of(use.task)];
    weight = std::max(weight, use.length);
  }
  weights.resize(rows.count());
  for (std::vector<std::int64_t>& row : weights) row.resize(columns.count());
  return heaviest_matching(weights);
}

}  // namespace

std::int64_t heaviest_matching(const Weights& weights) {
  if (weights.empty() || weights.front().empty()) return 0;
  if (weights.size() > weights.front().size()) return Assignment(transposed(weights)).total();
  return Assignment(weights).total();
}

std::vector<std::int64_t> blocking(const std::vector<std::size_t>& level,
                                   const std::vector<Use>& uses) {
  std::vector<std::int64_t> change(level.empty() ? 0 : level.back() + 1, 0);
  for (const Group& group : grouped(uses, level)) {
    // Between two levels of its members the blocking by a group stays the same.
    std::vector<std::size_t> levels = group.levels;
    std::sort(levels.begin(), levels.end());
    levels.erase(std::unique(levels.begin(), levels.end()), levels.end());
    std::int64_t before = 0;
    for (const std::size_t at : levels) {
      const std::int64_t now = blocking_by(group, at);
      change[at] += now - before;
      before = now;
    }
  }
  std::partial_sum(change.begin(), change.end(), change.begin());
  std::vector<std::int64_t> result;
  result.reserve(level.size());
  for (const std::size_t at : level) result.push_back(change[at]);
  return result;
}

}  // namespace mauve::analysis
