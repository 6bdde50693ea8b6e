// SPDX-License-Identifier: LGPL-3.0-or-later
/// The language of Graphviz: `mauvectl graph --dot | dot -Tpdf`.
#include "base/concat.h"
#include "picture/graph.h"
#include "picture/graph_look.h"
#include "picture/machine.h"
#include "picture/svg.h"

namespace mauve::ctl {
namespace {

constexpr std::string_view kHead =
    "  rankdir=LR;\n"
    "  nodesep=0.3;\n"
    "  ranksep=0.8;\n"
    "  node [shape=plain, fontname=\"Helvetica\", fontsize=11];\n"
    "  edge [fontname=\"Helvetica\", fontsize=9, arrowsize=0.7];\n";

std::string small(const std::string& text) {
  return concat({"<FONT POINT-SIZE=\"9\">", escaped_for_dot(text), "</FONT>"});
}

std::string row_of(const std::string& content) {
  return concat({"<TR><TD COLSPAN=\"2\">", content, "</TD></TR>"});
}

/// The ports and services that let data in stand on the left, those that let it out on the right.
std::string dot_doors(const Graph::Node& node) {
  std::vector<std::string> left;
  std::vector<std::string> right;
  const auto add = [&](const std::vector<Graph::Door>& doors, const char* id, bool in) {
    for (std::size_t i = 0; i < doors.size(); ++i) {
      auto& side = doors[i].reads() == in ? left : right;
      side.push_back(concat({" PORT=\"", id, i, "\">", escaped_for_dot(doors[i].name)}));
    }
  };
  add(node.services, "s", false);
  add(node.ports, "p", true);
  std::string text;
  for (std::size_t i = 0; i < std::max(left.size(), right.size()); ++i) {
    text += concat({"<TR><TD ALIGN=\"LEFT\"", i < left.size() ? left[i] : ">",
                    "</TD><TD ALIGN=\"RIGHT\"", i < right.size() ? right[i] : ">", "</TD></TR>"});
  }
  return text;
}

std::string dot_colours(const Graph::Node& node) {
  const NodeLook& look = look_of(node);
  return concat({"COLOR=\"", look.line, "\" BGCOLOR=\"", look.fill, "\""});
}

std::string dot_label(const Graph::Node& node) {
  std::string text = concat({"<TABLE ", node.is_resource ? "" : "STYLE=\"ROUNDED\" ",
                             "BORDER=\"1\" CELLBORDER=\"0\" CELLSPACING=\"0\" CELLPADDING=\"3\" ",
                             dot_colours(node), ">"});
  text += row_of(concat({"<B>", escaped_for_dot(node.name), "</B>"})) + row_of(small(node.type));
  if (!node.core.empty()) text += row_of(small(node.core));
  if (!node.fsm.empty()) text += row_of(small(concat({"fsm ", node.fsm, ": ", node.fsm_state})));
  if (!node.state.empty() && node.state != "running") text += row_of(small(node.state));
  return concat({text, dot_doors(node), "</TABLE>"});
}

std::string dot_style(const FlowLook& look) {
  std::string text = concat({", color=\"", look.line, "\""});
  if (look.stroke == Stroke::dashed) text += ", style=dashed";
  if (look.stroke == Stroke::dotted) text += ", style=dotted, penwidth=2";
  return look.word.empty() ? text : concat({text, ", label=\"", look.word, "\""});
}

std::string dot_edge(const Graph& graph, const Graph::Link& link) {
  const Graph::Door& port = graph.port(link);
  const std::string user = concat({"n", link.user, ":p", link.port});
  const std::string service = concat({"n", link.resource, ":s", link.service});
  const bool reads = port.reads();
  const std::string attributes =
      concat({"tooltip=\"", escaped_for_dot(concat({port.kind, " ", port.type})), "\"",
              port.kind == "call" || port.kind == "event" ? ", arrowhead=vee" : ""});
  return concat(
      {"  ",
       reads ? concat({service, ":e -> ", user, ":w"}) : concat({user, ":e -> ", service, ":w"}),
       " [", attributes, dot_style(look_of(link.flow)), "];\n"});
}

}  // namespace

/// In quoted strings of the language a backslash means something besides.
std::string escaped_for_dot(std::string_view text) {
  std::string result;
  for (const char letter : escaped_markup(text)) {
    letter == '\\' ? result += "&#92;" : result += letter;
  }
  return result;
}

std::string graph_dot(const Graph& graph) {
  std::string text = concat({"digraph \"", escaped_for_dot(graph.name), "\" {\n", kHead});
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    const Graph::Node& node = graph.nodes[i];
    text += concat({"  n", i, " [tooltip=\"", escaped_for_dot(node.name), "\", label=<",
                    dot_label(node), ">];\n"});
  }
  for (std::size_t i = 0; i < graph.nodes.size(); ++i) {
    for (std::size_t k = 0; k < graph.nodes[i].ports.size(); ++k) {
      if (graph.is_connected(i, k)) continue;
      const std::string id = concat({i, "_", k});
      text += concat(
          {"  open", id, " [shape=point, color=\"", kWrong, "\", tooltip=\"not connected\"];\n"});
      const std::string port = concat({"n", i, ":p", k});
      text += concat({"  ",
                      graph.nodes[i].ports[k].reads() ? concat({"open", id, " -> ", port, ":w"})
                                                      : concat({port, ":e -> open", id}),
                      " [color=\"", kWrong, "\", style=dotted, label=\"not connected\"];\n"});
    }
  }
  for (const Graph::Link& link : graph.links) text += dot_edge(graph, link);
  return text + "}\n";
}

std::string machine_dot(const Machine& machine) {
  std::string text = concat({"digraph \"", escaped_for_dot(machine.component), "\" {\n", kHead});
  text += "  begin [shape=point, width=0.12];\n";
  for (std::size_t i = 0; i < machine.states.size(); ++i) {
    const Machine::State& state = machine.states[i];
    const bool current = machine.current == i;
    text += concat({"  s", i, " [shape=box, style=\"", state.waits ? "filled" : "rounded,filled",
                    "\", fillcolor=\"", look_of(state, current).fill, "\"",
                    current ? ", penwidth=2" : "", ", label=<<B>", escaped_for_dot(state.name),
                    "</B>", state.waits ? "<BR/>" + escaped_for_dot(state.wait) : "", ">];\n"});
  }
  if (!machine.states.empty()) text += concat({"  begin -> s", machine.initial, ";\n"});
  for (std::size_t i = 0; i < machine.states.size(); ++i) {
    for (const Machine::Transition& one : machine.states[i].transitions) {
      text +=
          concat({"  s", i, " -> s", one.to, " [label=\"", escaped_for_dot(one.mark), "\"];\n"});
    }
  }
  return text + "}\n";
}

}  // namespace mauve::ctl
