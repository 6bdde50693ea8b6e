// SPDX-License-Identifier: LGPL-3.0-or-later
#include "analysis/machine.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace mauve::analysis {
namespace {

/// The control component of the paper: wait for a goal, reach it, rest at it.
Machine control() {
  Machine machine;
  machine.states = {
      running("wait_goal", 1ms, Source::declared, {1, 3}),
      running("reach_goal", 2ms, Source::measured, {2, 4}),
      running("at_goal", 3ms, Source::declared, {5}),
      waiting("idle", 100ms, {0}),
      waiting("pace", 10ms, {1}),
      waiting("settle", 50ms, {0}),
  };
  return machine;
}

const Vertex* find(const Graph& graph, const std::string& job) {
  const auto found = std::find_if(graph.vertices.begin(), graph.vertices.end(),
                                  [&](const Vertex& vertex) { return name(vertex) == job; });
  return found == graph.vertices.end() ? nullptr : &*found;
}

TEST(Machine, HasAJobForEachPairOfWaitsThatFollowEachOther) {
  const Graph graph = to_graph(control()).value();

  std::vector<std::string> jobs;
  for (const Vertex& vertex : graph.vertices) jobs.push_back(name(vertex));
  std::sort(jobs.begin(), jobs.end());
  EXPECT_EQ(jobs, (std::vector<std::string>{
                      "from idle to idle", "from idle to pace", "from idle to settle",
                      "from pace to pace", "from pace to settle", "from settle to idle",
                      "from settle to pace", "from settle to settle", "from start to idle",
                      "from start to pace", "from start to settle"}));
}

TEST(Machine, AJobTakesTheLongestPathOverItsExecutionStates) {
  const Graph graph = to_graph(control()).value();

  EXPECT_EQ(find(graph, "from idle to settle")->execution, 6ms);
  EXPECT_EQ(find(graph, "from idle to settle")->source, Source::measured);
  EXPECT_EQ(find(graph, "from idle to idle")->execution, 1ms);
  EXPECT_EQ(find(graph, "from idle to idle")->source, Source::declared);
}

TEST(Machine, ADeadlineIsTheNextWaitOrWhatIsDeclared) {
  const Graph own = to_graph(control()).value();
  const Graph declared = to_graph(control(), {20ms, 0ms}).value();

  EXPECT_EQ(find(own, "from idle to idle")->deadline, 100ms);
  EXPECT_EQ(find(own, "from idle to pace")->deadline, 10ms);
  EXPECT_EQ(find(declared, "from idle to idle")->deadline, 20ms);
  EXPECT_EQ(find(declared, "from idle to pace")->deadline, 10ms);
}

TEST(Machine, ASeparationIsTheWaitBetweenTheJobs) {
  const Graph graph = to_graph(control()).value();

  for (const Edge& edge : graph.edges) {
    const Vertex& from = graph.vertices[edge.from];
    EXPECT_EQ(from.to, graph.vertices[edge.to].from);
    EXPECT_EQ(edge.separation, from.to == "idle" ? 100ms : from.to == "pace" ? 10ms : 50ms);
  }
  EXPECT_EQ(graph.edges.size(), 29u);
}

TEST(Machine, ABudgetReplacesWhatIsKnownOfTheStates) {
  Machine machine = control();
  machine.states[2] = running("at_goal", 0ms, Source::unknown, {5});

  EXPECT_EQ(find(to_graph(machine).value(), "from pace to settle")->source, Source::unknown);
  const Graph declared = to_graph(machine, {0ms, 7ms}).value();
  EXPECT_EQ(find(declared, "from pace to settle")->source, Source::declared);
  EXPECT_EQ(find(declared, "from pace to settle")->execution, 7ms);
}

TEST(Machine, MayBeginWithAWait) {
  Machine machine;
  machine.states = {waiting("first", 5ms, {1}), waiting("second", 7ms, {0})};

  const Graph graph = to_graph(machine).value();

  ASSERT_EQ(graph.vertices.size(), 3u);
  EXPECT_EQ(find(graph, "from start to first")->execution, 0ms);
}

TEST(Machine, RefusesExecutionStatesThatNeverWait) {
  Machine machine = control();
  machine.states[2].next = {1};  // at_goal goes back to reach_goal at once

  const Result<Graph> graph = to_graph(machine);

  ASSERT_FALSE(graph);
  EXPECT_EQ(graph.error().code, Errc::cycle);
  EXPECT_EQ(graph.error().at, "reach_goal");
}

TEST(Machine, RefusesAWaitOfZeroAndTransitionsToNowhere) {
  Machine no_wait = control();
  no_wait.states[4].wait = 0ms;
  Machine nowhere = control();
  nowhere.states[4].next = {17};

  EXPECT_EQ(to_graph(no_wait).error().code, Errc::invalid_value);
  EXPECT_EQ(to_graph(no_wait).error().at, "pace");
  EXPECT_EQ(to_graph(nowhere).error().code, Errc::unknown_name);
  EXPECT_EQ(to_graph(Machine{}).error().code, Errc::unknown_name);
}

}  // namespace
}  // namespace mauve::analysis
