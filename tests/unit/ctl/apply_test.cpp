// SPDX-License-Identifier: LGPL-3.0-or-later
// apply, plan and diff: what is asked, what is printed, which exit code.
#include <string>

#include <gtest/gtest.h>

#include "render/render.h"
#include "unit/ctl/scene.h"

namespace mauve::ctl {
namespace {

constexpr const char* kFile = MAUVE_ETC_DIR "/minimal.json";

const Json kResult = Json::parse(R"({"generation": 42, "changed": true, "state": "applied",
  "same": false, "attempts": 1,
  "components": [{"name": "control", "pause_ns": 38, "missed": 0, "bytes": 24},
                 {"name": "watcher", "pause_ns": 0, "missed": 0, "bytes": 0}],
  "lines": [
    {"op": "add", "kind": "plugin", "address": "demo", "old": null, "new": "demo"},
    {"op": "remove", "kind": "resource", "address": "old", "old": "shared_data velocity/1",
     "new": null},
    {"op": "add", "kind": "component", "address": "watcher", "old": null, "new": "demo/counter"},
    {"op": "change", "kind": "component", "address": "safety", "old": "a/b", "new": "a/c"},
    {"op": "change", "kind": "property", "address": "control.core.gain", "old": 0.2, "new": 0.3},
    {"op": "add", "kind": "port", "address": "control.ports.scan", "old": null,
     "new": {"connect": "scan.read", "max_age": "50ms"}},
    {"op": "remove", "kind": "task", "address": "control.task.budget", "old": "2ms",
     "new": null}]})");

constexpr const char* kLines =
    "+ plugin demo\n"
    "- resource old (shared_data velocity/1)\n"
    "+ component watcher (demo/counter)\n"
    "~ component safety: a/b -> a/c\n"
    "~ control.core.gain: 0.2 -> 0.3\n"
    "+ control.ports.scan: {connect: scan.read, max_age: 50ms}\n"
    "- control.task.budget: 2ms\n";

const Json kSame = Json::parse(R"({"generation": 41, "changed": false, "state": "unchanged",
  "same": true, "components": [], "lines": []})");

TEST(RenderDiff, HasOneLineForEachDifference) {
  EXPECT_EQ(render_diff("rover.json", kResult, {}),
            std::string("--- what runs, generation 42\n+++ rover.json\n") + kLines);
}

TEST(RenderDiff, SaysThatApplyRefusesAnotherName) {
  const Json line = {{"op", "change"},
                     {"kind", "architecture"},
                     {"address", "name"},
                     {"old", "rover"},
                     {"new", "yard"}};

  EXPECT_EQ(render_diff("yard.json", {{"generation", 3}, {"lines", {line}}}, {}),
            "--- what runs, generation 3\n+++ yard.json\n~ name: rover -> yard (apply refuses "
            "this: keep the name, or start mauved with this file)\n");
}

TEST(RenderDiff, IsOneSentenceWhenNothingDiffers) {
  EXPECT_EQ(render_diff("rover.json", kSame, {}), "rover.json is what runs (generation 41)\n");
}

TEST(RenderDiff, AndAPlanShowNotesAlsoWhenNothingDiffers) {
  Json result = kSame;
  result["notes"] = {"slip runs build 9651293e"};
  const std::string same =
      "rover.json is what runs (generation 41)\nnote: slip runs build 9651293e\n";

  EXPECT_EQ(render_diff("rover.json", result, {}), same);
  EXPECT_EQ(render_plan("rover.json", result, {}), same);
  EXPECT_EQ(render_receipt("applied", result, {}),
            "nothing to change (generation 41 still running)\nnote: slip runs build 9651293e\n");
}

TEST(RenderDiff, SaysWhyMembersWaitForEachOtherAndWhatAPlanMayCost) {
  Json result = kResult;
  result["sync"] = "barrier";
  result["exchanged"] = {"fix", "scan"};
  result["components"][0]["missed"] = 2;

  EXPECT_EQ(render_applied("rover.json", result, {}).find(kLines), 0U);
  EXPECT_NE(render_applied("rover.json", result, {})
                .find("\nat a barrier, for another contract of fix, scan\napplied"),
            std::string::npos);
  EXPECT_NE(render_plan("rover.json", result, {})
                .find("\nat a barrier, for another contract of fix, scan; may lose: control 2 "
                      "releases\n"),
            std::string::npos);
  result.erase("exchanged");
  EXPECT_NE(render_applied("rover.json", result, {}).find("\nat a barrier\napplied"),
            std::string::npos)
      << "as asked";
}

TEST(RenderDiff, HasColoursForPeopleOnly) {
  const std::string text = render_diff("rover.json", kResult, {0, true});

  EXPECT_NE(text.find(painted("+", Paint::green, true) + " plugin"), std::string::npos);
  EXPECT_NE(text.find(painted("-", Paint::red, true) + " resource"), std::string::npos);
  EXPECT_NE(text.find(painted("~", Paint::yellow, true) + " component"), std::string::npos);
  EXPECT_EQ(render_diff("rover.json", kResult, {}).find('\033'), std::string::npos);
}

TEST(RenderDiff, SurvivesAnAnswerWithoutAnything) {
  EXPECT_FALSE(render_diff("x", Json(), {}).empty());
  EXPECT_FALSE(render_diff("x", {{"lines", {1, "two"}}}, {}).empty());
  EXPECT_FALSE(render_plan("x", Json::array(), {}).empty());
  EXPECT_FALSE(render_applied("x", Json::object(), {}).empty());
}

TEST(RenderApplied, EndsWithTheReceipt) {
  EXPECT_EQ(
      render_applied("rover.json", kResult, {}),
      std::string(kLines) +
          "applied rover.json: longest pause 38 ns, 0 releases missed, 24 bytes of state kept "
          "(generation 42)\n");
  EXPECT_EQ(render_applied("rover.json", kSame, {}),
            "nothing to change (generation 41 still running)\n");
}

TEST(RenderPlan, SaysWhoTakesPartAndWhatIsKept) {
  EXPECT_EQ(render_plan("rover.json", kResult, {}),
            std::string(kLines) +
                "everything is prepared and would be applied; at the same instant: control (24 "
                "bytes of state kept), watcher\n"
                "nothing was changed (generation 42 still running)\n");
  EXPECT_EQ(render_plan("rover.json", kSame, {}), "rover.json is what runs (generation 41)\n");
}

TEST(RenderPlan, SaysWhichCoreIsStatelessAndSoBeginsAnew) {
  Json result = kResult;
  result["components"].push_back({{"name", "drives"}, {"bytes", 0}, {"begins_anew", true}});
  EXPECT_NE(
      render_plan("rover.json", result, {}).find("watcher, drives (Stateless: begins anew)\n"),
      std::string::npos)
      << render_plan("rover.json", result, {});
}

TEST(RenderPlan, PrintsTheConsequencesThatTheReceiptPrints) {
  Json result = kResult;
  result["gone"] = Json::parse(R"([{"name": "speed", "before": 0.6}])");
  result["notes"] = {"a rollback continues with another state"};
  result["warnings"] = {"control: its job may never end"};
  const std::string consequences = remark_lines(result, {});

  EXPECT_EQ(consequences,
            "  speed (0.6) is gone: the new core has no such property\n"
            "note: a rollback continues with another state\n"
            "warning: control: its job may never end\n");
  EXPECT_NE(render_plan("rover.json", result, {}).find(consequences), std::string::npos);
  EXPECT_TRUE(render_receipt("applied", result, {}).ends_with(consequences));
}

TEST(RenderPlan, SaysWhichStateIsConvertedAndShowsTheNotes) {
  Json result = kResult;
  result["components"][0]["converted"] = "count/1 -> count/2";
  result["notes"] = {"a rollback continues with another state"};

  EXPECT_EQ(render_plan("rover.json", result, {}),
            std::string(kLines) +
                "everything is prepared and would be applied; at the same instant: control (state "
                "converted: count/1 -> count/2), watcher\n"
                "note: a rollback continues with another state\n"
                "nothing was changed (generation 42 still running)\n");
}

TEST(Apply, SendsTheTextOfTheFileAndWhatWasSaid) {
  const Scene scene({"apply", kFile, "--state", "drop", "--sync", "cut", "--probation", "off",
                     "--if-generation", "41", "--reason", "x"},
                    kResult);

  ASSERT_EQ(scene.asked.size(), 1U);
  EXPECT_EQ(scene.asked[0].method, "architecture.apply");
  const Json& params = scene.asked[0].params;
  EXPECT_NE(params["text"].get<std::string>().find("\"minimal\""), std::string::npos);
  EXPECT_EQ(params["file"], kFile);
  EXPECT_EQ(params["state"], "drop");
  EXPECT_EQ(params["sync"], "cut");
  EXPECT_EQ(params["probation"], "off");
  EXPECT_EQ(params["if_generation"], 41);
  EXPECT_EQ(params["reason"], "x");
  EXPECT_FALSE(params.contains("dry_run"));
  EXPECT_EQ(scene.outcome.exit, 0);
}

TEST(Apply, WithDryRunIsAPlan) {
  for (const Scene& scene :
       {Scene({"apply", kFile, "--dry-run"}, kResult), Scene({"plan", kFile}, kResult)}) {
    EXPECT_EQ(scene.asked[0].method, "architecture.apply");
    EXPECT_EQ(scene.asked[0].params["dry_run"], true);
    EXPECT_NE(scene.outcome.out.find("nothing was changed"), std::string::npos);
    EXPECT_EQ(scene.outcome.exit, 0);
  }
}

TEST(Diff, EndsWith0ForTheSameAnd1ForAnother) {
  const Scene other({"diff", kFile}, kResult);
  EXPECT_EQ(other.asked[0].method, "architecture.diff");
  EXPECT_EQ(other.outcome.exit, 1);
  EXPECT_EQ(Scene({"diff", kFile}, kSame).outcome.exit, 0);
  EXPECT_EQ(Json::parse(Scene({"--json", "diff", kFile}, kSame).outcome.out), kSame);
}

TEST(Diff, WantsAFileThatCanBeRead) {
  EXPECT_EQ(run("/nowhere", {"diff", "/nothing.json"}).exit, 2);
  EXPECT_EQ(run("/nowhere", {"apply", "/nothing.json"}).exit, 2);
  EXPECT_EQ(run("/nowhere", {"plan", "/tmp"}).exit, 2);
  EXPECT_EQ(run("/nowhere", {"diff", kFile}).exit, 7);
}

/// A command whose file is refused.
Outcome refused_file(std::vector<std::string> words) {
  FakeServer server([](Peer& peer) {
    peer.say(kHello);
    auto fault = protocol::fault_of(refuse(Errc::invalid_value, "f.json", "the file has 1 error"));
    fault.errors = Json::parse(R"([{"line": 3, "column": 5, "at": "control.core.gain",
      "message": "must be positive", "hint": "the range is 0 to 2"}])");
    peer.say(protocol::to_line(protocol::make_error(peer.hear().id, fault)) + "\n");
    peer.wait_for_the_end();
  });
  return run(server.path(), std::move(words));
}

TEST(Apply, PrintsAllErrorsOfTheFileAboveTheRefusal) {
  const Outcome outcome = refused_file({"apply", kFile});

  EXPECT_EQ(outcome.exit, 1);
  EXPECT_TRUE(outcome.out.empty());
  const std::string place = std::string(kFile) + ":3:5: error: control.core.gain: must be positive";
  const auto found = outcome.err.find(place);
  ASSERT_NE(found, std::string::npos) << outcome.err;
  EXPECT_LT(found, outcome.err.find("error: apply: the file has 1 error"));
}

TEST(Apply, GivesAllErrorsToScripts) {
  const Json error = Json::parse(refused_file({"--json", "apply", kFile}).out)["error"];

  EXPECT_EQ(error["exit"], 1);
  ASSERT_EQ(error["errors"].size(), 1U);
  EXPECT_EQ(error["errors"][0]["line"], 3);
}

TEST(Diff, DoesNotSayThatABadFileDiffers) { EXPECT_EQ(refused_file({"diff", kFile}).exit, 2); }

}  // namespace
}  // namespace mauve::ctl
