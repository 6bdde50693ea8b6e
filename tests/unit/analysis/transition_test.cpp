// SPDX-License-Identifier: LGPL-3.0-or-later
#include "analysis/transition.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "analysis/machine.h"

namespace mauve::analysis {
namespace {

/// Runs for `execution`, then waits in `wait`, again and again.
Graph loop(const std::string& wait, Duration period, Duration execution) {
  Machine machine;
  machine.states = {running("run", execution, Source::declared, {1}), waiting(wait, period, {0})};
  return to_graph(machine).value();
}

/// "from a to b, 10, from c to d" (times in ms), for each edge that leaves one part for another.
std::vector<std::string> bridges(const Graph& graph) {
  std::vector<std::string> found;
  for (const Edge& edge : graph.edges) {
    const Vertex& from = graph.vertices[edge.from];
    const Vertex& to = graph.vertices[edge.to];
    if (to.part != Part::first_after && to.part != Part::first_back) continue;
    found.push_back(name(from) + ", " + std::to_string(edge.separation / 1ms) + ", " + name(to));
  }
  std::sort(found.begin(), found.end());
  return found;
}

TEST(Transition, KeepsTheWaitUnderWayAndGoesOnInTheStateOfTheSameName) {
  const Graph both = transition(loop("pace", 10ms, 1ms), loop("pace", 20ms, 2ms), 5us);

  EXPECT_EQ(bridges(both),
            (std::vector<std::string>{
                "from pace to pace (first after the change), 20, from pace to pace (first after a "
                "rollback)",
                "from pace to pace (new), 20, from pace to pace (first after a rollback)",
                "from pace to pace (old), 10, from pace to pace (first after the change)",
                "from start to pace (new), 20, from pace to pace (first after a rollback)",
                "from start to pace (old), 10, from pace to pace (first after the change)"}));
}

TEST(Transition, BeginsAnewWhenNoStateHasTheName) {
  const std::vector<std::string> found =
      bridges(transition(loop("pace", 10ms, 1ms), loop("idle", 20ms, 2ms), 5us));

  EXPECT_TRUE(
      std::count(found.begin(), found.end(),
                 "from pace to pace (old), 10, from start to idle (first after the change)"));
  EXPECT_TRUE(
      std::count(found.begin(), found.end(),
                 "from idle to idle (new), 20, from start to pace (first after a rollback)"));
}

TEST(Transition, ChargesTheChangeToTheFirstJobOnly) {
  const Graph both = transition(loop("pace", 10ms, 1ms), loop("pace", 10ms, 2ms), 5us);

  ASSERT_FALSE(both.vertices.empty());
  for (const Vertex& vertex : both.vertices) {
    switch (vertex.part) {
      case Part::first_after:
        EXPECT_EQ(vertex.execution, 2005us);
        break;
      case Part::first_back:
        EXPECT_EQ(vertex.execution, 1005us);
        break;
      case Part::after:
        EXPECT_EQ(vertex.execution, 2ms);
        break;
      default:
        EXPECT_EQ(vertex.execution, 1ms);
    }
  }
}

TEST(Transition, NeverComesBackToTheNewVersionAfterARollback) {
  const Graph both = transition(loop("pace", 10ms, 1ms), loop("pace", 10ms, 2ms), 5us);

  ASSERT_FALSE(both.edges.empty());
  for (const Edge& edge : both.edges) {
    EXPECT_LE(both.vertices[edge.from].part, both.vertices[edge.to].part);
  }
}

Task task(const std::string& name, int cpu, Duration execution) {
  Task task;
  task.name = name;
  task.cpu = cpu;
  task.graph = loop("pace", 10ms, execution);
  return task;
}

const Task& find(const TaskSet& set, const std::string& name, Presence presence) {
  return *std::find_if(set.tasks.begin(), set.tasks.end(), [&](const Task& each) {
    return each.name == name && each.presence == presence;
  });
}

TEST(Transition, OfTaskSetsMarksWhatComesAndGoes) {
  const TaskSet before{{task("same", 0, 1ms), task("goes", 0, 1ms), task("moves", 0, 1ms)}, {}};
  const TaskSet after{{task("same", 0, 1ms), task("comes", 0, 1ms), task("moves", 1, 1ms)}, {}};

  const TaskSet both = transition(before, after);

  ASSERT_EQ(both.tasks.size(), 5u);
  EXPECT_EQ(find(both, "same", Presence::always).graph, before.tasks[0].graph);
  EXPECT_EQ(find(both, "goes", Presence::before).cpu, 0);
  EXPECT_EQ(find(both, "comes", Presence::after).cpu, 0);
  EXPECT_EQ(find(both, "moves", Presence::before).cpu, 0);
  EXPECT_EQ(find(both, "moves", Presence::after).cpu, 1);
}

TEST(Transition, OfTaskSetsJoinsOldAndNewOfAChangedTask) {
  TaskSet before{{task("a", 0, 1ms), task("b", 0, 1ms)}, {}};
  TaskSet after{{task("a", 0, 2ms), task("b", 0, 1ms)}, {}};
  before.tasks[0].sections = {{"map", 3us}, {"log", 1us}};
  after.tasks[0].sections = {{"map", 2us}, {"pose", 4us}};
  after.tasks[1].version = 1;  // another core with the same numbers

  const TaskSet both = transition(before, after);

  ASSERT_EQ(both.tasks.size(), 2u);
  EXPECT_EQ(both.tasks[0].sections,
            (std::vector<Section>{{"map", 3us}, {"log", 1us}, {"pose", 4us}}));
  EXPECT_EQ(both.tasks[0].graph,
            transition(before.tasks[0].graph, after.tasks[0].graph, after.overheads.change));
  EXPECT_NE(both.tasks[1].graph, before.tasks[1].graph);
}

}  // namespace
}  // namespace mauve::analysis
