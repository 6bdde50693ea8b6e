// SPDX-License-Identifier: LGPL-3.0-or-later
/// The running architecture as a graph, and its pictures (the paper's Fig. 11). Pure: an answer of
/// the daemon in, text out; the same answer gives the same bytes.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "render/words.h"

namespace mauve::ctl {

/// The state of the data on a connection.
enum class Flow {
  alive,
  resting,  ///< its component does not run
  stale,    ///< the values are older than the port allows
  dead,     ///< its component failed, or its resource refuses its users
};

struct Graph {
  /// A port, or a service of a resource.
  struct Door {
    std::string name;
    std::string kind;  ///< read, write, call or event
    std::string type;

    /// Data comes out of a service that is read; a port that reads takes it in.
    [[nodiscard]] bool reads() const { return kind == "read"; }
  };
  struct Node {
    bool is_resource = false;
    std::string name;
    std::string type;
    std::string core;
    std::string fsm;
    std::string fsm_state;
    std::string state;  ///< of a component: running, stopped...; of a resource: empty or poisoned
    std::vector<Door> ports;
    std::vector<Door> services;
  };
  /// From the port of `user` to the service of `resource`.
  struct Link {
    std::size_t user = 0;
    std::size_t port = 0;
    std::size_t resource = 0;
    std::size_t service = 0;
    Flow flow = Flow::alive;
  };

  std::string name;
  std::string generation;
  std::vector<Node> nodes;
  std::vector<Link> links;

  [[nodiscard]] bool is_connected(std::size_t node, std::size_t port) const;
  [[nodiscard]] const Door& port(const Link& link) const {
    return nodes[link.user].ports[link.port];
  }
};

/// Of the answer to architecture.graph. Connections that lead nowhere are left out.
[[nodiscard]] Graph graph_of(const Json& answer);

/// These elements, those that they are connected to, and the connections between all of them.
[[nodiscard]] Graph part_of(const Graph& graph, const std::vector<std::string>& names);

[[nodiscard]] std::string graph_dot(const Graph& graph);
[[nodiscard]] std::string graph_mermaid(const Graph& graph);
[[nodiscard]] std::string graph_svg(const Graph& graph);

/// A text within quotes or between tags: of Graphviz and HTML; of Mermaid.
[[nodiscard]] std::string escaped_for_dot(std::string_view text);
[[nodiscard]] std::string escaped_for_mermaid(std::string_view text);

}  // namespace mauve::ctl
