// SPDX-License-Identifier: LGPL-3.0-or-later
// The architecture as a picture: an answer in, DOT, Mermaid and SVG out.
#include "picture/graph.h"

#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "picture/graph_look.h"
#include "picture/layers.h"
#include "picture/machine.h"
#include "picture/svg.h"
#include "support/temp_dir.h"
#include "unit/ctl/scene.h"
#include "unit/ctl/svg_reader.h"

namespace mauve::ctl {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

const Json kAnswer = Json::parse(R"({"generation": 42, "architecture": "rover",
  "components": [
    {"name": "laser", "type": "drivers/laser", "core": "drivers/laser", "fsm": "drivers/laser",
     "fsm_state": "breathe", "state": "running", "ports": [
       {"name": "scan", "kind": "write", "type": "laser_scan/1", "service": "scan.write"}]},
    {"name": "control", "type": "guidance/control", "core": "guidance/gap",
     "fsm": "guidance/control", "fsm_state": "pace", "state": "running", "ports": [
       {"name": "scan", "kind": "read", "type": "laser_scan/1", "service": "scan.read",
        "status": "stale"},
       {"name": "goal", "kind": "read", "type": "point/1", "service": null},
       {"name": "drive", "kind": "call", "type": "velocity/1", "service": "motor.drive"}]},
    {"name": "joystick", "type": "teleop/joystick", "core": "teleop/joystick", "fsm": "f",
     "fsm_state": "period", "state": "stopped", "ports": [
       {"name": "out", "kind": "write", "type": "velocity/1", "service": "motor.set"}]},
    {"name": "broken", "type": "t/b", "core": "t/b", "fsm": "f", "fsm_state": "update",
     "state": "faulted", "ports": [
       {"name": "in", "kind": "read", "type": "laser_scan/1", "service": "scan.read"}]}],
  "resources": [
    {"name": "scan", "type": "shared_data", "poisoned": false, "services": [
       {"name": "read", "kind": "read", "type": "laser_scan/1"},
       {"name": "write", "kind": "write", "type": "laser_scan/1"}], "ports": []},
    {"name": "motor", "type": "drivers/motor", "poisoned": false, "services": [
       {"name": "drive", "kind": "call", "type": "velocity/1"},
       {"name": "set", "kind": "write", "type": "velocity/1"}], "ports": [
       {"name": "log", "kind": "write", "type": "x/1", "service": "gone.write"}]}]})");

Json hostile() {
  Json answer = kAnswer;
  answer["architecture"] = "a\"b<c>&d";
  answer["components"][0]["type"] = "x<y>&\"z\"\\`|#;]]> --> \x1b[31m" + std::string(4000, 'w');
  answer["components"][0]["fsm_state"] = "<script>alert(1)</script>";
  return answer;
}

TEST(Graph, FollowsTheDirectionOfData) {
  const Graph graph = graph_of(kAnswer);

  ASSERT_EQ(graph.nodes.size(), 6U);
  ASSERT_EQ(graph.links.size(), 5U) << "a port without a service has none, nor has a lost one";
  EXPECT_FALSE(graph.port(graph.links[0]).reads());
  EXPECT_TRUE(graph.port(graph.links[1]).reads());
  const std::string dot = graph_dot(graph);
  EXPECT_THAT(dot, HasSubstr("n0:p0:e -> n4:s1:w")) << "laser writes scan";
  EXPECT_THAT(dot, HasSubstr("n4:s0:e -> n1:p0:w")) << "control reads it";
  EXPECT_THAT(dot, HasSubstr("n1:p2:e -> n5:s0:w")) << "and calls the motor";
}

TEST(Graph, KnowsWhatDoesNotFlow) {
  Json answer = kAnswer;
  Graph graph = graph_of(answer);

  EXPECT_EQ(graph.links[0].flow, Flow::alive);
  EXPECT_EQ(graph.links[1].flow, Flow::stale);
  EXPECT_EQ(graph.links[3].flow, Flow::resting) << "the joystick is stopped";
  EXPECT_EQ(graph.links[4].flow, Flow::dead) << "of a component that failed";
  EXPECT_FALSE(graph.is_connected(1, 1));
  answer["resources"][0]["poisoned"] = true;
  EXPECT_EQ(graph_of(answer).links[0].flow, Flow::dead);
}

TEST(Graph, OfSomeElementsHasTheirNeighbours) {
  const Graph part = part_of(graph_of(kAnswer), {"joystick"});

  ASSERT_EQ(part.nodes.size(), 2U);
  EXPECT_EQ(part.nodes[0].name, "joystick");
  EXPECT_EQ(part.nodes[1].name, "motor");
  ASSERT_EQ(part.links.size(), 1U);
  EXPECT_EQ(part.links[0].resource, 1U);
}

TEST(Graph, OfAnAnswerThatMakesNoSenseIsEmpty) {
  for (const char* text : {"null", "{}", R"({"components": [1, {"ports": 3}], "resources": {}})"}) {
    const Graph graph = graph_of(Json::parse(text));
    EXPECT_THAT(graph_svg(graph), HasSubstr("</svg>")) << text;
    EXPECT_THAT(graph_dot(graph), StartsWith("digraph")) << text;
  }
}

/// Graphviz itself reads it: what it says on standard error, or "skipped".
std::string graphviz_says(const std::string& text) {
  const test::TempDir place;
  const std::string file = place.write("graph.dot", text).string();
  const std::string errors = (place / "errors").string();
  if (std::system("command -v dot >/dev/null") != 0) return "skipped";
  const int code = std::system(("dot -Tsvg -o /dev/null " + file + " 2> " + errors).c_str());
  return (code == 0 ? "" : "failed: ") + test::TempDir::read(errors);
}

TEST(GraphAsDot, IsReadByGraphviz) {
  const std::string said = graphviz_says(graph_dot(graph_of(kAnswer)));
  if (said == "skipped") GTEST_SKIP() << "graphviz is not installed: scripts/setup";
  EXPECT_EQ(said, "");
  EXPECT_EQ(graphviz_says(graph_dot(graph_of(hostile()))), "");
}

TEST(GraphAsDot, MarksWhatIsStaleDeadOrOpen) {
  const std::string dot = graph_dot(graph_of(kAnswer));

  EXPECT_THAT(dot, HasSubstr("label=\"stale\""));
  EXPECT_THAT(dot, HasSubstr("label=\"dead\""));
  EXPECT_THAT(dot, HasSubstr("open1_1 -> n1:p1:w"));
  EXPECT_THAT(dot, HasSubstr("label=\"not connected\""));
}

TEST(GraphAsMermaid, HasAllNodesAndConnections) {
  const std::string text = graph_mermaid(graph_of(kAnswer));

  EXPECT_THAT(text, StartsWith("flowchart LR\n"));
  EXPECT_THAT(text, HasSubstr("n1(\"<b>control</b><br/>guidance/control<br/>guidance/gap"
                              "<br/>fsm guidance/control: pace\"):::running"));
  EXPECT_THAT(text, HasSubstr("n4[\"<b>scan</b><br/>shared_data\"]:::resource"));
  EXPECT_THAT(text, HasSubstr("n0 -->|\"scan - write\"| n4"));
  EXPECT_THAT(text, HasSubstr("n4 -->|\"read - scan #40;stale#41;\"| n1"));
  EXPECT_THAT(text, HasSubstr("linkStyle 1 stroke:#bc4c00,stroke-dasharray:7 4\n"));
  EXPECT_THAT(text, HasSubstr("n2(\"<b>joystick</b><br/>teleop/joystick<br/>teleop/joystick"
                              "<br/>fsm f: period<br/>stopped\"):::resting"));
}

TEST(GraphAsMermaid, KeepsHostileTextsInTheirQuotes) {
  const std::string text = graph_mermaid(graph_of(hostile()));

  EXPECT_THAT(text, HasSubstr("x#60;y#62;#38;#34;z#34;#92;#96;#124;#35;#59;#93;#93;#62; --#62; "));
  EXPECT_THAT(text, Not(HasSubstr("<script>")));
  EXPECT_THAT(text, Not(HasSubstr("\x1b")));
}

TEST(GraphAsSvg, ShowsEveryElementPortAndConnection) {
  const Graph graph = graph_of(kAnswer);
  const std::string svg = graph_svg(graph);

  for (const Graph::Node& node : graph.nodes) {
    EXPECT_THAT(svg, HasSubstr(">" + node.name + "</text>"));
    for (const auto& door : node.ports) EXPECT_THAT(svg, HasSubstr(">" + door.name + "</text>"));
    for (const auto& door : node.services) EXPECT_THAT(svg, HasSubstr(">" + door.name + "</text>"));
  }
  EXPECT_EQ(count_in(svg, "class=\"component\""), 4U);
  EXPECT_EQ(count_in(svg, "class=\"resource\""), 2U);
  EXPECT_EQ(count_in(svg, "class=\"link\""), 5U);
  EXPECT_THAT(svg, HasSubstr("<title>control.ports.scan - scan.read (stale)</title>"));
  EXPECT_THAT(svg, HasSubstr("<title>broken.ports.in - scan.read (dead)</title>"));
  EXPECT_THAT(svg, HasSubstr("stroke-dasharray=\"7 4\""));
}

TEST(GraphAsSvg, KeepsEveryTextWithinThePicture) {
  for (const Json& answer : {kAnswer, hostile()}) {
    const std::string svg = graph_svg(graph_of(answer));
    EXPECT_EQ(outside(svg), "");
    EXPECT_EQ(unbalanced(svg), "");
    EXPECT_THAT(svg, Not(HasSubstr("<script>")));
    EXPECT_THAT(svg, Not(HasSubstr("nan")));
  }
}

TEST(GraphAsSvg, IsTheSameForTheSameAnswer) {
  EXPECT_EQ(graph_svg(graph_of(kAnswer)), graph_svg(graph_of(kAnswer)));
}

/// So many components in a row, each writing what the next one reads, and the last what the first
/// one reads; all read one more.
Json circle_of(int count) {
  Json answer = {{"generation", 1}, {"architecture", "many"}};
  answer["resources"].push_back({{"name", "common"},
                                 {"type", "shared_data"},
                                 {"services", {{{"name", "read"}, {"kind", "read"}}}}});
  for (int i = 0; i < count; ++i) {
    const std::string from = "d" + std::to_string(i) + ".read";
    const std::string to = "d" + std::to_string((i + 1) % count) + ".write";
    answer["components"].push_back(
        {{"name", "c" + std::to_string(i)},
         {"state", "running"},
         {"ports",
          {{{"name", "in"}, {"kind", "read"}, {"service", from}},
           {{"name", "common"}, {"kind", "read"}, {"service", "common.read"}},
           {{"name", "out"}, {"kind", "write"}, {"service", to}}}}});
    answer["resources"].push_back(
        {{"name", "d" + std::to_string(i)},
         {"type", "shared_data"},
         {"services",
          {{{"name", "read"}, {"kind", "read"}}, {{"name", "write"}, {"kind", "write"}}}}});
  }
  return answer;
}

TEST(GraphAsSvg, OfACircleHasOneEdgeBack) {
  const Graph graph = graph_of(circle_of(12));
  std::vector<Wire> wires;
  for (const auto& link : graph.links) {
    if (graph.port(link).reads()) {
      wires.push_back({link.resource, 0, link.user, 0});
    } else {
      wires.push_back({link.user, 0, link.resource, 0});
    }
  }
  const auto columns = columns_of(graph.nodes.size(), wires);

  EXPECT_EQ(std::count_if(wires.begin(), wires.end(),
                          [&](const Wire& wire) { return columns[wire.to] <= columns[wire.from]; }),
            1);
  EXPECT_EQ(outside(graph_svg(graph)), "");
}

TEST(Arrangement, LeavesNoBoxOnAnotherAndNoWireInABox) {
  const std::vector<Box> boxes{{80, 60}, {120, 40}, {60, 90}, {80, 30}, {70, 50}, {50, 20}};
  const std::vector<Wire> wires{{0, 10, 1, 20}, {0, 10, 2, 20}, {1, 10, 3, 15}, {2, 40, 3, 20},
                                {3, 15, 0, 30}, {0, 50, 3, 10}, {2, 60, 4, 5}};

  const Arrangement all = arrange(boxes, wires);

  const auto within = [&](const Place& place, std::size_t i) {
    return place.x > all.corners[i].x + 0.1 && place.x < all.corners[i].x + all.widths[i] - 0.1 &&
           place.y > all.corners[i].y + 0.1 && place.y < all.corners[i].y + boxes[i].height - 0.1;
  };
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    for (std::size_t k = 0; k < boxes.size(); ++k) {
      const bool apart = i == k || all.corners[i].x + all.widths[i] <= all.corners[k].x ||
                         all.corners[k].x + all.widths[k] <= all.corners[i].x ||
                         all.corners[i].y + boxes[i].height <= all.corners[k].y ||
                         all.corners[k].y + boxes[k].height <= all.corners[i].y;
      EXPECT_TRUE(apart) << i << " " << k;
    }
    for (const auto& route : all.routes) {
      for (std::size_t p = 1; p < route.size(); ++p) {
        for (int step = 0; step <= 100; ++step) {
          const double part = step / 100.0;
          const Place place{route[p - 1].x + (route[p].x - route[p - 1].x) * part,
                            route[p - 1].y + (route[p].y - route[p - 1].y) * part};
          EXPECT_FALSE(within(place, i)) << "box " << i;
        }
      }
    }
  }
  for (std::size_t i = 0; i < wires.size(); ++i) {
    const auto& route = all.routes[i];
    EXPECT_NEAR(route.front().y, all.corners[wires[i].from].y + wires[i].from_y, 0.1);
    EXPECT_NEAR(route.back().y, all.corners[wires[i].to].y + wires[i].to_y, 0.1);
    for (std::size_t p = 1; p < route.size(); ++p) {
      EXPECT_TRUE(std::abs(route[p].x - route[p - 1].x) < 0.1 ||
                  std::abs(route[p].y - route[p - 1].y) < 0.1)
          << "right angles only";
    }
  }
}

const Json kControl = Json::parse(R"({"address": "control", "kind": "component",
  "fsm": "guidance/control", "state": "running", "fsm_state": "idle", "machine": {
    "initial": "wait_goal", "states": [
      {"name": "wait_goal", "kind": "execution", "transitions": [
        {"to": "reach_goal", "guarded": true}, {"to": "idle", "guarded": false}]},
      {"name": "idle", "kind": "synchronization", "wait_ns": 100000000, "transitions": [
        {"to": "wait_goal", "guarded": false}]},
      {"name": "reach_goal", "kind": "execution", "transitions": [
        {"to": "idle", "guarded": true}, {"to": "wait_goal", "guarded": true},
        {"to": "pace", "guarded": false}]},
      {"name": "pace", "kind": "synchronization", "wait_ns": 10000000, "transitions": [
        {"to": "reach_goal", "guarded": false}]}]}})");

TEST(GraphLook, IsTheSameInAllLanguages) {
  const Graph graph = graph_of(kAnswer);
  const std::string texts[] = {graph_dot(graph), graph_mermaid(graph), graph_svg(graph)};
  for (const Graph::Node& node : graph.nodes) {
    for (const std::string& text : texts) {
      EXPECT_THAT(text, HasSubstr(std::string(look_of(node).line))) << node.name;
      EXPECT_THAT(text, HasSubstr(std::string(look_of(node).fill))) << node.name;
    }
  }
  for (const Flow flow : {Flow::resting, Flow::stale, Flow::dead}) {
    for (const std::string& text : texts) {
      EXPECT_THAT(text, HasSubstr(std::string(look_of(flow).line)));
      EXPECT_THAT(text, HasSubstr(std::string(look_of(flow).word)));
    }
  }
}

TEST(Machine, MarksGuardsInTheirOrder) {
  const Machine machine = machine_of(kControl);

  ASSERT_EQ(machine.states.size(), 4U);
  EXPECT_EQ(machine.states[1].wait, "100 ms");
  ASSERT_EQ(machine.states[2].transitions.size(), 3U);
  EXPECT_EQ(machine.states[2].transitions[0].mark, "[1]");
  EXPECT_EQ(machine.states[2].transitions[1].mark, "[2]");
  EXPECT_EQ(machine.states[2].transitions[2].mark, "[else]");
  EXPECT_EQ(machine.states[3].transitions[0].mark, "") << "nothing to choose";
  EXPECT_EQ(machine.current, 1U);
  Json stopped = kControl;
  stopped["state"] = "stopped";
  EXPECT_EQ(machine_of(stopped).current, std::nullopt);
}

TEST(Machine, AsDotIsReadByGraphviz) {
  const std::string said = graphviz_says(machine_dot(machine_of(kControl)));
  if (said == "skipped") GTEST_SKIP() << "graphviz is not installed: scripts/setup";
  EXPECT_EQ(said, "");
}

TEST(Machine, IsDrawnInThreeLanguages) {
  const Machine machine = machine_of(kControl);
  EXPECT_THAT(machine_dot(machine), HasSubstr("begin -> s0"));
  EXPECT_THAT(machine_dot(machine), HasSubstr("s2 -> s0 [label=\"[2]\"]"));
  const std::string mermaid = machine_mermaid(machine);
  EXPECT_THAT(mermaid, StartsWith("stateDiagram-v2\n"));
  EXPECT_THAT(mermaid, HasSubstr("[*] --> s0"));
  EXPECT_THAT(mermaid, HasSubstr("s2 --> s3 : #91;else#93;"));
  EXPECT_THAT(mermaid, HasSubstr("class s1 current"));
  const std::string svg = machine_svg(machine);
  EXPECT_EQ(count_in(svg, "class=\"state\""), 3U);
  EXPECT_EQ(count_in(svg, "class=\"state current\""), 1U);
  EXPECT_EQ(count_in(svg, "class=\"transition\""), 7U);
  EXPECT_EQ(count_in(svg, "class=\"initial\""), 1U);
  EXPECT_THAT(svg, HasSubstr(">100 ms</text>"));
  EXPECT_EQ(outside(svg), "");
  EXPECT_EQ(unbalanced(svg), "");
}

TEST(GraphCommand, ChoosesTheLanguageByTheFile) {
  const test::TempDir place;
  for (const auto& [name, begin] : std::vector<std::pair<std::string, std::string>>{
           {"a.svg", "<svg"}, {"a.mmd", "flowchart"}, {"a.dot", "digraph"}, {"a", "digraph"}}) {
    const std::string file = (place / name).string();
    const Scene scene({"graph", "-o", file}, kAnswer);
    EXPECT_EQ(scene.outcome.exit, 0);
    EXPECT_EQ(scene.asked[0].method, "architecture.graph");
    EXPECT_THAT(test::TempDir::read(file), StartsWith(begin)) << name;
  }
  EXPECT_THAT(Scene({"graph", "--mermaid"}, kAnswer).outcome.out, StartsWith("flowchart"));
  EXPECT_THAT(Scene({"graph"}, kAnswer).outcome.out, StartsWith("digraph"));
  EXPECT_EQ(Json::parse(Scene({"--json", "graph"}, kAnswer).outcome.out), kAnswer);
}

TEST(GraphCommand, AnswersAsJsonWhatItWouldDraw) {
  const Json answer = Json::parse(Scene({"--json", "graph", "laser"}, kAnswer).outcome.out);

  Json expected = kAnswer;
  expected["components"] = Json::array({kAnswer["components"][0]});
  expected["resources"] = Json::array({kAnswer["resources"][0]});
  EXPECT_EQ(answer, expected) << "laser, and the scan that it writes";
}

TEST(GraphCommand, NamesTheFileAsJson) {
  const test::TempDir place;
  for (const bool machine : {false, true}) {
    const std::string file = (place / (machine ? "fsm.svg" : "all.svg")).string();
    std::vector<std::string> words{"--json", "graph", "-o", file};
    if (machine) words.insert(words.end(), {"--fsm", "control"});
    const Scene scene(words, machine ? kControl : kAnswer);

    EXPECT_EQ(Json::parse(scene.outcome.out), (Json{{"file", file}, {"replaced", false}}));
    EXPECT_THAT(test::TempDir::read(file), StartsWith("<svg"));
  }
}

TEST(GraphCommand, DrawsTheStateMachineOfAComponent) {
  const Scene scene({"graph", "--fsm", "control", "--svg"}, kControl);

  EXPECT_EQ(scene.asked[0].method, "object.get");
  EXPECT_THAT(scene.outcome.out, HasSubstr("class=\"state current\""));
  const Scene resource({"graph", "--fsm", "scan"}, {{"address", "scan"}, {"kind", "resource"}});
  EXPECT_EQ(resource.outcome.exit, 2);
  EXPECT_THAT(resource.outcome.err, HasSubstr("has no state machine"));
}

TEST(GraphCommand, RefusesWhatItCannotDo) {
  const Scene unknown({"graph", "contrl"}, kAnswer);
  EXPECT_EQ(unknown.outcome.exit, 4);
  EXPECT_THAT(unknown.outcome.err, HasSubstr("control"));
  EXPECT_EQ(run("/nowhere", {"graph", "--dot", "--svg"}).exit, 2);
  EXPECT_THAT(run("/nowhere", {"graph", "-o", "a.b/rover.png"}).err, HasSubstr("say its form"));
  EXPECT_EQ(run("/nowhere", {"graph", "control", "--fsm", "control"}).exit, 2);
  EXPECT_EQ(Scene({"graph", "-o", "/nowhere/a.svg"}, kAnswer).outcome.exit, 2);
}

}  // namespace
}  // namespace mauve::ctl
