// SPDX-License-Identifier: LGPL-3.0-or-later
#include "analysis/blocking.h"

#include <functional>

#include <gtest/gtest.h>

#include "random_systems.h"

namespace mauve::analysis {
namespace {

/// The best of all choices, each computed.
std::int64_t best_of_all(const Weights& weights) {
  std::vector<bool> used(weights.empty() ? 0 : weights.front().size(), false);
  const std::function<std::int64_t(std::size_t)> from = [&](std::size_t row) -> std::int64_t {
    if (row == weights.size()) return 0;
    std::int64_t most = from(row + 1);
    for (std::size_t column = 0; column < used.size(); ++column) {
      if (used[column]) continue;
      used[column] = true;
      most = std::max(most, weights[row][column] + from(row + 1));
      used[column] = false;
    }
    return most;
  };
  return from(0);
}

TEST(HeaviestMatching, IsTheBestOfAllChoices) {
  random_systems::Random random(3);
  for (int i = 0; i < 400; ++i) {
    const std::size_t columns = 1 + random.below(5);
    Weights weights(1 + random.below(5), std::vector<std::int64_t>(columns, 0));
    for (auto& row : weights) {
      for (std::int64_t& weight : row) weight = random.chance(60) ? random.between(1, 20) : 0;
    }
    ASSERT_EQ(heaviest_matching(weights), best_of_all(weights)) << "matrix " << i;
  }
}

TEST(HeaviestMatching, OfNothingIsNothing) {
  EXPECT_EQ(heaviest_matching({}), 0);
  EXPECT_EQ(heaviest_matching({{}}), 0);
}

TEST(Blocking, TakesEachLowerTaskAndEachResourceOnce) {
  // Task 0 uses both resources; 1 and 2 are below it.
  const std::vector<Use> uses{{0, 0, 1}, {0, 1, 1}, {1, 0, 5}, {1, 1, 4}, {2, 0, 3}, {2, 1, 1}};

  // 4 by task 1 in resource 1, and 3 by task 2 in resource 0; then 3; then nobody is below.
  EXPECT_EQ(blocking({0, 1, 2}, uses), (std::vector<std::int64_t>{7, 3, 0}));
}

TEST(Blocking, ReachesTasksThatUseNoResource) {
  // Task 1 is held up while task 2 inherits the priority of task 0.
  EXPECT_EQ(blocking({0, 1, 2}, {{0, 0, 1}, {2, 0, 5}}), (std::vector<std::int64_t>{5, 5, 0}));
}

TEST(Blocking, IsNoneByEqualPrioritiesOrAmongLowerTasksOnly) {
  EXPECT_EQ(blocking({0, 0}, {{0, 0, 1}, {1, 0, 5}}), (std::vector<std::int64_t>{0, 0}));
  EXPECT_EQ(blocking({0, 1, 2}, {{1, 0, 2}, {2, 0, 5}}), (std::vector<std::int64_t>{0, 5, 0}));
}

TEST(Blocking, OfALargeGroupIsBoundedAndNeverTooSmall) {
  std::vector<Use> uses;
  std::vector<std::size_t> level;
  for (std::size_t i = 0; i < 100; ++i) {  // a chain: each shares a resource with the next
    level.push_back(i);
    uses.push_back({i, i, 10});
    uses.push_back({i, i + 1, 10});
  }

  const std::vector<std::int64_t> times = blocking(level, uses);

  for (std::size_t i = 0; i + 1 < 100; ++i) EXPECT_EQ(times[i], 10) << i;
  EXPECT_EQ(times[99], 0);
}

}  // namespace
}  // namespace mauve::analysis
