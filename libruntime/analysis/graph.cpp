// SPDX-License-Identifier: LGPL-3.0-or-later
#include "analysis/graph.h"

#include <algorithm>

namespace mauve::analysis {

std::string_view to_string(Source source) {
  switch (source) {
    case Source::declared:
      return "declared";
    case Source::measured:
      return "measured";
    case Source::unknown:
      return "unknown";
  }
  return "unknown";
}

std::string name(const Vertex& vertex) {
  std::string text = "from " + (vertex.from.empty() ? "start" : vertex.from) + " to " + vertex.to;
  switch (vertex.part) {
    case Part::steady:
      break;
    case Part::before:
    case Part::back:
      return text + " (old)";
    case Part::first_after:
      return text + " (first after the change)";
    case Part::after:
      return text + " (new)";
    case Part::first_back:
      return text + " (first after a rollback)";
  }
  return text;
}

Graph periodic(Duration period, Duration execution) {
  return {{{"period", "period", execution, period, Source::declared, Part::steady}},
          {{0, 0, period}}};
}

Arcs::Arcs(const Graph& graph) : first_(graph.vertices.size() + 1, 0), arcs_(graph.edges.size()) {
  for (const Edge& edge : graph.edges) ++first_[edge.from + 1];
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for (const Edge& edge : graph.edges) {
    arcs_[next[edge.from]++] = {edge.to, std::max<std::int64_t>(edge.separation.count(), 1)};
  }
}

}  // namespace mauve::analysis
