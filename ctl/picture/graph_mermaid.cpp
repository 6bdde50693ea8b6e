// SPDX-License-Identifier: LGPL-3.0-or-later
/// Mermaid, which Markdown viewers draw.
#include "base/concat.h"
#include "picture/graph.h"
#include "picture/graph_look.h"
#include "picture/machine.h"

namespace mauve::ctl {
namespace {

std::string class_line(std::string_view name, std::string_view fill, std::string_view line,
                       const std::string& more) {
  return concat({"  classDef ", name, " fill:", fill, ",stroke:", line, more, "\n"});
}

std::string mermaid_label(const Graph::Node& node) {
  std::string text = concat({"<b>", escaped_for_mermaid(node.name), "</b>"});
  const auto add = [&](const std::string& line) {
    if (!line.empty()) text += "<br/>" + escaped_for_mermaid(line);
  };
  add(node.type);
  add(node.core);
  if (!node.fsm.empty()) add(concat({"fsm ", node.fsm, ": ", node.fsm_state}));
  if (node.state != "running") add(node.state);
  return text;
}

/// Solid lines in the usual colour need none.
std::string style_of(std::size_t link, Flow flow) {
  if (flow == Flow::alive) return {};
  const FlowLook& look = look_of(flow);
  const std::string text = concat({"  linkStyle ", link, " stroke:", look.line});
  if (look.stroke == Stroke::solid) return text + "\n";
  return concat({text, ",stroke-dasharray:", look.stroke == Stroke::dashed ? "7 4" : "2 3", "\n"});
}

/// "scan", or "fix to scan" where port and service have different names.
std::string mermaid_edge(const Graph& graph, const Graph::Link& link) {
  const Graph::Door& port = graph.port(link);
  const Graph::Door& service = graph.nodes[link.resource].services[link.service];
  const std::string user = concat({"n", link.user});
  const std::string resource = concat({"n", link.resource});
  std::string words = concat({port.name, " - ", service.name});
  if (port.reads()) words = concat({service.name, " - ", port.name});
  if (const auto word = look_of(link.flow).word; !word.empty()) {
    words += concat({" (", word, ")"});
  }
  const std::string arrow = concat({" -->|\"", escaped_for_mermaid(words), "\"| "});
  return concat({"  ", port.reads() ? resource + arrow + user : user + arrow + resource, "\n"});
}

}  // namespace

std::string escaped_for_mermaid(std::string_view text) {
  constexpr std::string_view kSpecial = "#\"&<>`|;{}[]()\\*~";
  std::string result;
  for (const char letter : text) {
    const bool control = static_cast<unsigned char>(letter) < ' ';
    const bool special = control || kSpecial.find(letter) != std::string_view::npos;
    result += special ? concat({"#", static_cast<int>(letter), ";"}) : std::string(1, letter);
  }
  return result;
}

std::string graph_mermaid(const Graph& graph) {
  std::string text = "flowchart LR\n";
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    const Graph::Node& node = graph.nodes[i];
    text += concat({"  n", i, node.is_resource ? "[\"" : "(\"", mermaid_label(node),
                    node.is_resource ? "\"]" : "\")", ":::", look_of(node).name, "\n"});
  }
  std::string styles;
  for (std::size_t i = 0; i < graph.links.size(); ++i) {
    text += mermaid_edge(graph, graph.links[i]);
    styles += style_of(i, graph.links[i].flow);
  }
  std::size_t edges = graph.links.size();
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    for (std::size_t k = 0; k < graph.nodes[i].ports.size(); ++k) {
      if (graph.is_connected(i, k)) continue;
      const Graph::Door& port = graph.nodes[i].ports[k];
      const std::string open = concat({"open", i, "_", k});
      const std::string user = concat({"n", i});
      const std::string arrow = concat({" -->|\"", escaped_for_mermaid(port.name), "\"| "});
      text += concat({"  ", open, "((\"not connected\")):::failed\n"});
      text += concat({"  ", port.reads() ? open + arrow + user : user + arrow + open, "\n"});
      styles += style_of(edges++, Flow::dead);
    }
  }
  text += styles;
  for (const NodeLook& look : node_looks()) {
    text += class_line(look.name, look.fill, look.line, concat({",color:", look.text}));
  }
  return text;
}

std::string machine_mermaid(const Machine& machine) {
  std::string text = "stateDiagram-v2\n  direction LR\n";
  for (std::size_t i = 0; i < machine.states.size(); ++i) {
    const Machine::State& state = machine.states[i];
    text += concat({"  state \"", escaped_for_mermaid(state.name),
                    state.waits ? " " + escaped_for_mermaid(state.wait) : "", "\" as s", i, "\n"});
  }
  if (!machine.states.empty()) text += concat({"  [*] --> s", machine.initial, "\n"});
  for (std::size_t i = 0; i < machine.states.size(); ++i) {
    for (const Machine::Transition& one : machine.states[i].transitions) {
      text += concat({"  s", i, " --> s", one.to,
                      one.mark.empty() ? "" : " : " + escaped_for_mermaid(one.mark), "\n"});
    }
  }
  const Machine::State waiting{{}, true, {}, {}};
  const StateLook calm = look_of(waiting, false);
  const StateLook current = look_of(waiting, true);
  text += class_line("waiting", calm.fill, calm.line, "");
  text += class_line("current", current.fill, current.line, ",stroke-width:2px");
  for (std::size_t i = 0; i < machine.states.size(); ++i) {
    if (machine.states[i].waits) text += concat({"  class s", i, " waiting\n"});
  }
  if (machine.current) text += concat({"  class s", *machine.current, " current\n"});
  return text;
}

}  // namespace mauve::ctl
