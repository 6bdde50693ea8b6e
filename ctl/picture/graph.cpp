// SPDX-License-Identifier: LGPL-3.0-or-later
#include "picture/graph.h"

#include <algorithm>
#include <map>
#include <utility>

#include "base/concat.h"

namespace mauve::ctl {
namespace {

bool is_true(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && *found == true;
}

std::vector<Graph::Door> doors_of(const Json& rows) {
  std::vector<Graph::Door> doors;
  for (const Json& row : rows) {
    doors.push_back({word(row, "name"), word(row, "kind"), word(row, "type")});
  }
  return doors;
}

Graph::Node node_of(const Json& row, bool is_resource) {
  Graph::Node node;
  node.is_resource = is_resource;
  node.name = word(row, "name");
  node.type = word(row, "type");
  node.core = word(row, "core");
  node.fsm = word(row, "fsm");
  node.fsm_state = word(row, "fsm_state");
  node.state = word(row, "state");
  if (is_resource) node.state = row.is_object() && is_true(row, "poisoned") ? "poisoned" : "";
  node.ports = doors_of(list_in(row, "ports"));
  node.services = doors_of(list_in(row, "services"));
  return node;
}

Flow flow_of(const Graph::Node& user, const Graph::Node& resource, const std::string& status) {
  const bool poisoned = user.state == "poisoned" || resource.state == "poisoned";
  const bool failed = user.state == "faulted" || user.state == "recovering";
  if (poisoned || failed || status == "poisoned") return Flow::dead;
  if (!user.is_resource && user.state != "running") return Flow::resting;
  return status == "stale" ? Flow::stale : Flow::alive;
}

/// "scan.read" to its place.
using Services = std::map<std::string, std::pair<std::size_t, std::size_t>>;

Services services_of(const Graph& graph) {
  Services all;
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    const auto& services = graph.nodes[i].services;
    for (std::size_t k = 0; k < services.size(); ++k) {
      all[concat({graph.nodes[i].name, ".", services[k].name})] = {i, k};
    }
  }
  return all;
}

}  // namespace

bool Graph::is_connected(std::size_t node, std::size_t port) const {
  return std::any_of(links.begin(), links.end(),
                     [&](const Link& link) { return link.user == node && link.port == port; });
}

Graph graph_of(const Json& answer) {
  Graph graph;
  graph.name = word(answer, "architecture");
  graph.generation = word(answer, "generation");
  std::vector<const Json*> rows;
  for (const char* key : {"components", "resources"}) {
    for (const Json& row : list_in(answer, key)) {
      graph.nodes.push_back(node_of(row, std::string_view(key) == "resources"));
      rows.push_back(&row);
    }
  }
  const Services services = services_of(graph);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Json& ports = list_in(*rows[i], "ports");
    for (std::size_t k = 0; k < ports.size(); ++k) {
      const auto found = services.find(word(ports[k], "service"));
      if (found == services.end()) continue;
      const auto [resource, service] = found->second;
      const Flow flow = flow_of(graph.nodes[i], graph.nodes[resource], word(ports[k], "status"));
      graph.links.push_back({i, k, resource, service, flow});
    }
  }
  return graph;
}

Graph part_of(const Graph& graph, const std::vector<std::string>& names) {
  std::vector<bool> kept(graph.nodes.size());
  for (std::size_t i = 0; i < kept.size(); ++i) {
    kept[i] = std::find(names.begin(), names.end(), graph.nodes[i].name) != names.end();
  }
  const std::vector<bool> named = kept;
  for (const Graph::Link& link : graph.links) {
    if (named[link.user] || named[link.resource]) kept[link.user] = kept[link.resource] = true;
  }
  Graph part;
  part.name = graph.name;
  part.generation = graph.generation;
  std::vector<std::size_t> place(kept.size());
  for (std::size_t i = 0; i < kept.size(); ++i) {
    place[i] = part.nodes.size();
    if (kept[i]) part.nodes.push_back(graph.nodes[i]);
  }
  for (Graph::Link link : graph.links) {
    if (!kept[link.user] || !kept[link.resource]) continue;
    link.user = place[link.user];
    link.resource = place[link.resource];
    part.links.push_back(link);
  }
  return part;
}

}  // namespace mauve::ctl
