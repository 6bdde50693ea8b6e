// SPDX-License-Identifier: LGPL-3.0-or-later
#include "analysis/rbf.h"

#include <functional>

#include <gtest/gtest.h>

#include "random_systems.h"

namespace mauve::analysis {
namespace {

Costs executions(const Graph& graph) {
  Costs costs;
  for (const Vertex& vertex : graph.vertices) costs.push_back(vertex.execution.count());
  return costs;
}

/// By walking every path.
std::int64_t walked(const Graph& graph, const Costs& costs, std::int64_t window) {
  std::int64_t most = 0;
  const std::function<void(std::size_t, std::int64_t, std::int64_t)> walk =
      [&](std::size_t vertex, std::int64_t at, std::int64_t work) {
        if (at >= window) return;
        work += costs[vertex];
        most = std::max(most, work);
        for (const Edge& edge : graph.edges) {
          if (edge.from == vertex) walk(edge.to, at + edge.separation.count(), work);
        }
      };
  for (std::size_t i = 0; i < costs.size(); ++i) walk(i, 0, 0);
  return most;
}

TEST(RequestBound, IsThatOfEveryPathWalkedOneByOne) {
  random_systems::Random random(7);
  for (int i = 0; i < 240; ++i) {
    const Graph graph = random_systems::small_graph(random);
    const Costs costs = executions(graph);
    const Steps steps = request_bound(Arcs(graph), costs, 30);
    for (int j = 0; j < 6; ++j) {
      const std::int64_t window = random.between(0, 30);
      ASSERT_EQ(value(steps, window), walked(graph, costs, window))
          << "graph " << i << ", window " << window;
    }
  }
}

TEST(RequestBound, CountsJobsWhenEachCostsOne) {
  random_systems::Random random(8);
  for (int i = 0; i < 50; ++i) {
    const Graph graph = random_systems::small_graph(random);
    const Costs ones(graph.vertices.size(), 1);
    const Steps steps = request_bound(Arcs(graph), ones, 25);

    EXPECT_EQ(value(steps, 25), walked(graph, ones, 25));
  }
}

TEST(RequestBound, OfAPeriodicTaskIsAStaircase) {
  const Graph graph = periodic(10ns, 3ns);

  EXPECT_EQ(request_bound(Arcs(graph), executions(graph), 25), (Steps{{0, 3}, {10, 6}, {20, 9}}));
}

TEST(RequestBound, HasEachJobOfAMultiframeTask) {
  Graph graph;
  graph.vertices = {{"a", "b", 5ns, 10ns, Source::declared, Part::steady},
                    {"b", "a", 1ns, 10ns, Source::declared, Part::steady}};
  graph.edges = {{0, 1, 10ns}, {1, 0, 10ns}};

  EXPECT_EQ(request_bound(Arcs(graph), executions(graph), 35),
            (Steps{{0, 5}, {10, 6}, {20, 11}, {30, 12}}));
}

TEST(Cover, IsAboveTheRequestBoundAndNotFarAbove) {
  random_systems::Random random(9);
  for (int i = 0; i < 200; ++i) {
    const Graph graph = random_systems::small_graph(random);
    const Costs costs = executions(graph);
    const Cover line = cover(Arcs(graph), costs);
    const Steps steps = request_bound(Arcs(graph), costs, 2000);
    for (const std::int64_t window : {1, 2, 10, 100, 1000, 2000}) {
      const auto exact = static_cast<double>(value(steps, window));
      ASSERT_GE(line.value(static_cast<double>(window)) + 1e-6, exact) << "graph " << i;
    }
    EXPECT_NEAR(line.rate * 2000, static_cast<double>(value(steps, 2000)), 100) << "graph " << i;
  }
}

TEST(Cover, HasTheRateOfTheDearestCycle) {
  Graph graph;
  graph.vertices = {{"a", "a", 5ns, 10ns, Source::declared, Part::steady},
                    {"a", "b", 1ns, 10ns, Source::declared, Part::steady}};
  graph.edges = {{0, 0, 20ns}, {0, 1, 10ns}, {1, 0, 4ns}};

  EXPECT_DOUBLE_EQ(cover(Arcs(graph), executions(graph)).rate, 6.0 / 14);
}

TEST(Steps, OneAfterTheOtherTakesTheWorstInstantOfChange) {
  const Steps first{{0, 2}, {10, 4}, {20, 6}};
  const Steps then{{0, 5}, {30, 10}};

  const Steps both = one_after_the_other(first, then, 40);

  for (std::int64_t window = 1; window <= 40; ++window) {
    std::int64_t most = 0;
    for (std::int64_t change = 0; change <= window; ++change) {
      // Just after a release of the first, so that it still counts.
      most =
          std::max(most, value(first, std::min(change + 1, window)) + value(then, window - change));
    }
    EXPECT_EQ(value(both, window), most) << window;
  }
}

TEST(Steps, ASumThatGrowsIsTheSum) {
  const Steps a{{0, 2}, {10, 4}};
  const Steps b{{0, 1}, {7, 3}, {10, 9}};
  StepSum growing({0, 10, 7, 0, 10});

  growing.add(a);
  EXPECT_EQ(growing.value(11), 4);
  growing.add(b);

  for (std::int64_t window = 0; window < 15; ++window) {
    EXPECT_EQ(growing.value(window), value(a, window) + value(b, window)) << window;
    EXPECT_EQ(growing.value(window), value(sum({&a, &b}), window)) << window;
  }
}

}  // namespace
}  // namespace mauve::analysis
