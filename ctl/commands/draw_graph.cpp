// SPDX-License-Identifier: LGPL-3.0-or-later
#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

#include "base/name.h"
#include "cli/output.h"
#include "commands/actions.h"
#include "picture/graph.h"
#include "picture/machine.h"
#include "render/table.h"
#include "render/words.h"

namespace mauve::ctl {
namespace {

using protocol::fault_of;
using protocol::wrong_use;

enum class Form { dot, mermaid, svg };

constexpr std::string_view kEndings[] = {".svg", ".mmd", ".mermaid", ".dot", ".gv"};

OutputKind output_of(const Session& session, Form form) {
  if (form == Form::svg) return {"<svg ", kEndings};
  if (form == Form::dot) return {"digraph ", kEndings};
  return {session.arguments.has("--fsm") ? "stateDiagram" : "flowchart ", kEndings};
}

/// The form that an option names, else that of the ending of the file.
std::variant<Form, Fault> form_of(const Arguments& given) {
  const int said = (given.has("--dot") ? 1 : 0) + (given.has("--mermaid") ? 1 : 0) +
                   (given.has("--svg") ? 1 : 0);
  if (said > 1) {
    return wrong_use("usage_options_conflict", "one of --dot, --mermaid and --svg", {},
                     "example: mauvectl graph --svg -o rover.svg");
  }
  const std::string file = given.one("-o,--output");
  if (given.has("--svg") || (said == 0 && file.ends_with(".svg"))) return Form::svg;
  const bool mermaid = file.ends_with(".mmd") || file.ends_with(".mermaid");
  return given.has("--mermaid") || (said == 0 && mermaid) ? Form::mermaid : Form::dot;
}

std::string drawn(const Graph& graph, Form form) {
  if (form == Form::dot) return graph_dot(graph);
  return form == Form::svg ? graph_svg(graph) : graph_mermaid(graph);
}

std::string drawn(const Machine& machine, Form form) {
  if (form == Form::dot) return machine_dot(machine);
  return form == Form::svg ? machine_svg(machine) : machine_mermaid(machine);
}

std::optional<Fault> unknown_name(const Graph& graph, const std::vector<std::string>& wanted) {
  std::vector<std::string> known;
  for (const Graph::Node& node : graph.nodes) known.push_back(node.name);
  for (const std::string& name : wanted) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    Fault fault = fault_of(refuse({Errc::unknown_name, "unknown_address"}, name,
                                  "there is nothing of this name", known_names(name, known)));
    return fault;
  }
  return std::nullopt;
}

/// The report, when the picture goes into a file.
std::string reported_for(const Session& session, const std::string& drawn) {
  return !output_file(session).empty() ? "drew " + drawn : std::string();
}

/// The answer with the rows of drawn elements only.
Json part_of(Json answer, const Graph& drawn) {
  for (const char* key : {"components", "resources"}) {
    Json rows = Json::array();
    for (const Json& row : list_in(answer, key)) {
      const auto same = [&](const Graph::Node& node) { return node.name == word(row, "name"); };
      if (std::any_of(drawn.nodes.begin(), drawn.nodes.end(), same)) rows.push_back(row);
    }
    answer[key] = std::move(rows);
  }
  return answer;
}

/// With --json the answer itself, unless the picture goes into a file.
bool wants_answer(const Session& session) {
  return session.screen.json && output_file(session).empty();
}

int draw_machine(Session& session, Form form) {
  const std::string name = session.arguments.one("--fsm");
  const auto answer = session.call("object.get", {{"address", name}});
  if (const auto* fault = std::get_if<Fault>(&answer)) return session.fail(*fault);
  const auto& object = std::get<Json>(answer);
  const Machine machine = machine_of(object);
  if (machine.states.empty()) {
    return session.fail(wrong_use("usage_no_state_machine", "has no state machine", name,
                                  "mauvectl list components"));
  }
  if (wants_answer(session)) {
    session.print(object.value("machine", Json()), {});
    return 0;
  }
  return write_output(session, output_of(session, form), drawn(machine, form),
                      reported_for(session, "the state machine of " + name));
}

}  // namespace

int run_graph(Session& session) {
  const auto form = form_of(session.arguments);
  if (const auto* fault = std::get_if<Fault>(&form)) return session.fail(*fault);
  const OutputKind kind = output_of(session, std::get<Form>(form));
  if (const auto fault = refused_output(session, kind)) return session.fail(*fault);
  const auto names = session.arguments.all("ELEMENT");
  if (session.arguments.has("--fsm")) {
    if (names.empty()) return draw_machine(session, std::get<Form>(form));
    return session.fail(wrong_use("usage_options_conflict", "--fsm draws one component alone", {},
                                  "example: mauvectl graph --fsm control -o control.svg"));
  }
  const auto answer = session.call("architecture.graph", Json::object());
  if (const auto* fault = std::get_if<Fault>(&answer)) return session.fail(*fault);
  const auto& result = std::get<Json>(answer);
  Graph graph = graph_of(result);
  if (const auto fault = unknown_name(graph, names)) return session.fail(*fault);
  if (!names.empty()) graph = part_of(graph, names);
  if (wants_answer(session)) {
    session.print(names.empty() ? result : part_of(result, graph), {});
    return 0;
  }
  const int code = write_output(session, kind, drawn(graph, std::get<Form>(form)),
                                reported_for(session, counted(graph.nodes.size(), "element")));
  for (const Json& note : names.empty() ? list_in(result, "notes") : Json::array()) {
    session.screen.err << "note: " << harmless(word(note, "address") + " " + word(note, "text"))
                       << "\n";
  }
  return code;
}

}  // namespace mauve::ctl
