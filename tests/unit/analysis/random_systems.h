// SPDX-License-Identifier: LGPL-3.0-or-later
/// Random graphs and task sets, the same for the same seed on every machine.
#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "analysis/machine.h"
#include "analysis/task_set.h"

namespace random_systems {

using mauve::Duration;
using mauve::analysis::Graph;
using mauve::analysis::Machine;

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  /// From `least` to `most`, both included.
  std::int64_t between(std::int64_t least, std::int64_t most) {
    const auto span = static_cast<std::uint64_t>(most - least) + 1;
    return least + static_cast<std::int64_t>(engine_() % span);
  }
  std::size_t below(std::size_t count) {
    return static_cast<std::size_t>(between(0, static_cast<std::int64_t>(count) - 1));
  }
  bool chance(int percent) { return between(1, 100) <= percent; }
  Duration time(Duration least, Duration most) {
    return Duration(between(least.count(), most.count()));
  }

 private:
  std::mt19937_64 engine_;
};

/// A digraph without meaning: small numbers, so that many paths tie.
inline Graph small_graph(Random& random) {
  Graph graph;
  const std::size_t count = 1 + random.below(5);
  for (std::size_t i = 0; i < count; ++i) {
    mauve::analysis::Vertex vertex;
    vertex.from = vertex.to = std::to_string(i);
    vertex.execution = Duration(random.between(0, 9));
    vertex.deadline = Duration(1000);
    graph.vertices.push_back(std::move(vertex));
  }
  for (std::uint32_t from = 0; from < count; ++from) {
    for (std::uint32_t to = 0; to < count; ++to) {
      if (random.chance(45)) graph.edges.push_back({from, to, Duration(random.between(2, 12))});
    }
  }
  return graph;
}

/// A state machine with the waits `names`, each of `period` or a multiple, and jobs of at most
/// about `work`.
inline Machine machine(Random& random, const std::vector<std::string>& names, Duration period,
                       Duration work) {
  Machine machine;
  const std::size_t waits = names.size();
  const std::size_t runs = 1 + random.below(3);
  const auto any_wait = [&] { return random.below(waits); };
  for (const std::string& name : names) {
    machine.states.push_back(mauve::analysis::waiting(name, period * random.between(1, 3),
                                                      {waits + random.below(runs)}));
    if (random.chance(20)) machine.states.back().next.push_back(any_wait());
  }
  for (std::size_t i = 0; i < runs; ++i) {
    std::vector<std::size_t> next{any_wait(), any_wait()};
    if (i + 1 < runs) next.push_back(waits + i + 1);
    machine.states.push_back(mauve::analysis::running(
        "run" + std::to_string(i), random.time(work / 20, work / static_cast<int>(runs)),
        mauve::analysis::Source::measured, std::move(next)));
  }
  machine.initial = random.below(machine.states.size());
  return machine;
}

inline Graph machine_graph(Random& random, std::vector<std::string> names, Duration period,
                           Duration work) {
  return mauve::analysis::to_graph(machine(random, names, period, work)).value();
}

}  // namespace random_systems
