// SPDX-License-Identifier: LGPL-3.0-or-later
#include "analysis/machine.h"

#include <algorithm>
#include <map>

namespace mauve::analysis {
namespace {

/// The longest path found so far.
struct Longest {
  Duration execution{0};
  Source source = Source::declared;
};

/// Longest paths to each wait that can come next; by the index of the wait.
using Reach = std::map<std::size_t, Longest>;

/// The reach of every state, each looked at once.
class Walk {
 public:
  explicit Walk(const Machine& machine)
      : machine_(machine),
        marks_(machine.states.size(), Mark::unseen),
        reaches_(machine.states.size()) {}

  /// From the beginning of `state` (an execution state), or from the end of a wait.
  Status follow(std::size_t state) {
    if (marks_[state] == Mark::done) return ok();
    const Machine::State& at = machine_.states[state];
    marks_[state] = Mark::open;
    for (const std::size_t next : at.next) {
      if (machine_.states[next].waits) {
        join(reaches_[state][next], {at.execution, at.source});
        continue;
      }
      if (marks_[next] == Mark::open) return endless(next);
      if (Status followed = follow(next); !followed) return followed;
      for (const auto& [wait, path] : reaches_[next]) {
        join(reaches_[state][wait],
             {at.execution + path.execution, std::max(at.source, path.source)});
      }
    }
    marks_[state] = Mark::done;
    return ok();
  }
  [[nodiscard]] const Reach& reach(std::size_t state) const { return reaches_[state]; }

 private:
  enum class Mark : std::uint8_t { unseen, open, done };

  /// An unknown path may be the longest, so it makes the whole unknown.
  static void join(Longest& longest, const Longest& path) {
    longest.execution = std::max(longest.execution, path.execution);
    longest.source = std::max(longest.source, path.source);
  }
  [[nodiscard]] Error endless(std::size_t state) const {
    return refuse({Errc::cycle, "fsm_never_waits"}, machine_.states[state].name,
                  "execution states follow each other for ever without a wait",
                  "put a synchronization state into the cycle");
  }

  const Machine& machine_;
  std::vector<Mark> marks_;
  std::vector<Reach> reaches_;
};

Status verify(const Machine& machine) {
  if (machine.initial >= machine.states.size()) {
    return refuse({Errc::unknown_name, "fsm_leads_nowhere"}, "",
                  "the machine has no initial state");
  }
  for (const Machine::State& state : machine.states) {
    if (state.waits && state.wait <= Duration{0}) {
      return refuse({Errc::invalid_value, "fsm_incomplete"}, state.name,
                    "a wait must be longer than zero");
    }
    for (const std::size_t next : state.next) {
      if (next < machine.states.size()) continue;
      return refuse({Errc::unknown_name, "fsm_leads_nowhere"}, state.name,
                    "a transition leads to no state");
    }
  }
  return ok();
}

/// Collects the vertices, by the wait that releases them, and connects them.
class Builder {
 public:
  Builder(const Machine& machine, const JobLimits& limits) : machine_(machine), limits_(limits) {}

  void add(const std::string& from, std::size_t to, const Longest& path) {
    const Duration wait = machine_.states[to].wait;
    Vertex vertex{from, machine_.states[to].name, path.execution, wait, path.source, Part::steady};
    if (limits_.deadline > Duration{0}) vertex.deadline = std::min(limits_.deadline, wait);
    if (limits_.budget > Duration{0}) {
      vertex.execution = limits_.budget;
      vertex.source = Source::declared;
    }
    graph_.vertices.push_back(std::move(vertex));
    ends_in_.push_back(to);
  }
  void begin(std::size_t wait) { begins_[wait] = graph_.vertices.size(); }
  void end(std::size_t wait) { ends_[wait] = graph_.vertices.size(); }

  Graph connected() {
    for (std::size_t i = 0; i < graph_.vertices.size(); ++i) {
      const std::size_t wait = ends_in_[i];
      for (std::size_t j = begins_[wait]; j < ends_[wait]; ++j) {
        graph_.edges.push_back({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j),
                                machine_.states[wait].wait});
      }
    }
    return std::move(graph_);
  }

 private:
  const Machine& machine_;
  const JobLimits& limits_;
  Graph graph_;
  std::vector<std::size_t> ends_in_;
  std::map<std::size_t, std::size_t> begins_;
  std::map<std::size_t, std::size_t> ends_;
};

}  // namespace

Machine::State waiting(std::string name, Duration wait, std::vector<std::size_t> next) {
  return {std::move(name), true, wait, Duration{0}, Source::declared, std::move(next)};
}

Machine::State running(std::string name, Duration execution, Source source,
                       std::vector<std::size_t> next) {
  const Duration counted = source == Source::unknown ? Duration{0} : execution;
  return {std::move(name), false, Duration{0}, counted, source, std::move(next)};
}

Result<Graph> to_graph(const Machine& machine, const JobLimits& limits) {
  if (Status sound = verify(machine); !sound) return sound.error();
  Walk walk(machine);
  Builder builder(machine, limits);
  std::vector<bool> seen(machine.states.size(), false);
  std::vector<std::size_t> open;
  const auto meet = [&](const std::string& from, std::size_t to, const Longest& path) {
    builder.add(from, to, path);
    if (!seen[to]) open.push_back(to);
    seen[to] = true;
  };

  if (machine.states[machine.initial].waits) {
    meet("", machine.initial, {});
  } else {
    if (Status followed = walk.follow(machine.initial); !followed) return followed.error();
    for (const auto& [to, path] : walk.reach(machine.initial)) meet("", to, path);
  }
  while (!open.empty()) {
    const std::size_t wait = open.back();
    open.pop_back();
    if (Status followed = walk.follow(wait); !followed) return followed.error();
    builder.begin(wait);
    for (const auto& [to, path] : walk.reach(wait)) {
      meet(machine.states[wait].name, to, path);
    }
    builder.end(wait);
  }
  return builder.connected();
}

}  // namespace mauve::analysis
