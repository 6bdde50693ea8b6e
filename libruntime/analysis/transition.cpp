// SPDX-License-Identifier: LGPL-3.0-or-later
#include "analysis/transition.h"

#include <algorithm>
#include <map>
#include <string_view>

namespace mauve::analysis {
namespace {

/// The vertices of a graph by the wait that releases them.
using Released = std::multimap<std::string_view, std::uint32_t>;

Released released(const Graph& graph) {
  Released result;
  for (std::uint32_t i = 0; i < graph.vertices.size(); ++i) {
    result.emplace(graph.vertices[i].from, i);
  }
  return result;
}

/// For each vertex the wait that follows it.
std::vector<Duration> waits(const Graph& graph) {
  std::vector<Duration> result(graph.vertices.size(), Duration::max());
  for (const Edge& edge : graph.edges) {
    result[edge.from] = std::min(result[edge.from], edge.separation);
  }
  for (std::size_t i = 0; i < result.size(); ++i) {
    if (result[i] == Duration::max()) result[i] = graph.vertices[i].deadline;
  }
  return result;
}

/// Versions of a component one after the other, with the jobs that lead from each to the next.
class Layers {
 public:
  /// Appends a version; the number of its first vertex.
  std::uint32_t add(const Graph& version, Part part) {
    const std::uint32_t offset = size();
    for (const Vertex& vertex : version.vertices) {
      graph_.vertices.push_back(vertex);
      graph_.vertices.back().part = part;
    }
    for (const Edge& edge : version.edges) {
      graph_.edges.push_back({offset + edge.from, offset + edge.to, edge.separation});
    }
    const std::vector<Duration> added = waits(version);
    waits_.insert(waits_.end(), added.begin(), added.end());
    return offset;
  }

  /// From the vertices [`begin`, `end`) to the version `to` at `offset`, by copies of the first
  /// jobs there; these take `change` longer.
  void bridge(std::uint32_t begin, std::uint32_t end, const Graph& to, std::uint32_t offset,
              Part part, Duration change) {
    const Released by = released(to);
    std::map<std::uint32_t, std::uint32_t> copies;
    for (std::uint32_t i = begin; i < end; ++i) {
      const std::string state = graph_.vertices[i].to;
      const auto [first, last] = by.equal_range(by.contains(state) ? state : std::string_view());
      for (auto next = first; next != last; ++next) {
        const auto [copy, made] = copies.try_emplace(next->second, size());
        if (made) append_copy(offset + next->second, part, change);
        graph_.edges.push_back({i, copy->second, waits_[i]});
      }
    }
    for (const Edge& edge : to.edges) {
      const auto copy = copies.find(edge.from);
      if (copy == copies.end()) continue;
      graph_.edges.push_back({copy->second, offset + edge.to, edge.separation});
    }
  }
  [[nodiscard]] std::uint32_t size() const {
    return static_cast<std::uint32_t>(graph_.vertices.size());
  }
  Graph take() { return std::move(graph_); }

 private:
  void append_copy(std::uint32_t original, Part part, Duration change) {
    Vertex copy = graph_.vertices[original];
    copy.part = part;
    copy.execution += change;
    graph_.vertices.push_back(std::move(copy));
    waits_.push_back(waits_[original]);
  }

  Graph graph_;
  std::vector<Duration> waits_;
};

/// The longest use of each resource in either.
std::vector<Section> joined(std::vector<Section> sections, const std::vector<Section>& others) {
  for (const Section& other : others) {
    const auto same = std::find_if(sections.begin(), sections.end(), [&](const Section& section) {
      return section.resource == other.resource;
    });
    if (same == sections.end()) {
      sections.push_back(other);
    } else {
      same->length = std::max(same->length, other.length);
      same->source = std::max(same->source, other.source);
    }
  }
  return sections;
}

bool unchanged(const Task& before, const Task& after) {
  return before.version == after.version && before.offset == after.offset &&
         before.jitter == after.jitter && before.sections == after.sections &&
         before.graph == after.graph;
}

Task changed(const Task& before, const Task& after, Duration change) {
  Task task = after;
  task.jitter = std::max(before.jitter, after.jitter);
  task.sections = joined(before.sections, after.sections);
  task.graph = transition(before.graph, after.graph, change);
  return task;
}

Task present(Task task, Presence presence) {
  task.presence = presence;
  return task;
}

}  // namespace

Graph transition(const Graph& before, const Graph& after, Duration change) {
  Layers layers;
  layers.add(before, Part::before);
  const std::uint32_t next = layers.add(after, Part::after);
  layers.bridge(0, next, after, next, Part::first_after, change);
  const std::uint32_t back = layers.add(before, Part::back);
  layers.bridge(next, back, before, back, Part::first_back, change);
  return layers.take();
}

TaskSet transition(const TaskSet& before, const TaskSet& after) {
  TaskSet both{{}, after.overheads};
  std::map<std::string_view, const Task*> old;
  for (const Task& task : before.tasks) old.emplace(task.name, &task);
  for (const Task& task : after.tasks) {
    const auto found = old.find(task.name);
    const bool moved = found != old.end() &&
                       (found->second->cpu != task.cpu || found->second->priority != task.priority);
    if (found == old.end() || moved) {
      both.tasks.push_back(present(task, Presence::after));
      continue;
    }
    both.tasks.push_back(unchanged(*found->second, task)
                             ? task
                             : changed(*found->second, task, after.overheads.change));
    old.erase(found);
  }
  for (const Task& task : before.tasks) {
    if (old.contains(task.name)) both.tasks.push_back(present(task, Presence::before));
  }
  return both;
}

}  // namespace mauve::analysis
