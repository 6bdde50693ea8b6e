// SPDX-License-Identifier: LGPL-3.0-or-later
#include "render/render.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mauve::ctl {
namespace {

const Json kStatus = Json::parse(R"({
  "generation": 42, "architecture": "rover", "uptime_s": 192.5, "realtime": true,
  "components": [
    {"name": "laser", "type": "drivers/laser_sim", "core": "drivers/laser_sim",
     "fsm_state": "period",
     "state": "running", "priority": 60, "releases": 7680, "missed": 0, "overruns": 0},
    {"name": "control", "type": "guidance/control", "core": "guidance/potential_field",
     "fsm_state": "reach_goal", "state": "stopped", "priority": 40, "releases": 19200, "missed": 3,
     "overruns": 0}]})");

const Json kReceipt = Json::parse(R"({"generation": 42, "changed": true, "state": "applied",
  "commit": 918273000000, "attempts": 1,
  "components": [{"name": "control", "pause_ns": 38, "missed": 0, "bytes": 0}]})");

Json receipt_with(const char* key, Json value) {
  Json receipt = kReceipt;
  receipt[key] = std::move(value);
  return receipt;
}

TEST(RenderStatus, IsATable) {
  EXPECT_EQ(
      render_status(kStatus, {}),
      "rover: 1 of 2 components running, generation 42, up 3 min 12 s, real time\n"
      "NAME     STATE    FSM         CORE                      PRIO  RELEASES  MISSED  OVERRUNS\n"
      "laser    running  period      drivers/laser_sim           60      7680       0         0\n"
      "control  stopped  reach_goal  guidance/potential_field    40     19200       3         0\n");
}

TEST(RenderStatus, SaysWhatIsLockedAndNotSaved) {
  const Json status = Json::parse(
      R"({"generation":4,"architecture":"a","components":[],"lock":"params","saved":false})");

  EXPECT_EQ(render_status(status, {}),
            "a: 0 of 0 components running, generation 4, NOT saved, params locked\n");
  EXPECT_THAT(render_status(Json::parse(R"({"generation":4,"architecture":"a","components":[],
    "saved":true,"disk_silent_s":12.5})"),
                            {}),
              testing::HasSubstr("generation 4, the DISK has not answered for 12"));
}

TEST(RenderStatus, FitsInto80Columns) {
  const std::string text = render_status(kStatus, {80, false});

  EXPECT_EQ(text,
            "rover: 1 of 2 components running, generation 42, up 3 min 12 s, real time\n"
            "NAME     STATE    FSM         CORE                      PRIO  MISSED  OVERRUNS\n"
            "laser    running  period      drivers/laser_sim           60       0         0\n"
            "control  stopped  reach_goal  guidance/potential_field    40       3         0\n");
}

TEST(RenderStatus, FitsInto40ColumnsWithWholeNames) {
  const std::string text = render_status(kStatus, {40, false});

  EXPECT_EQ(text,
            "rover: 1 of 2 components running,\n"
            "  generation 42, up 3 min 12 s, real\n"
            "  time\n"
            "NAME     STATE    FSM         MISSED\n"
            "laser    running  period           0\n"
            "control  stopped  reach_goal       3\n");
}

TEST(RenderStatus, HasEscapesOnlyWithColours) {
  EXPECT_EQ(render_status(kStatus, {}).find('\033'), std::string::npos);
  EXPECT_NE(render_status(kStatus, {0, true}).find("\033[32mrunning"), std::string::npos);
}

TEST(RenderStatus, SaysWhyAComponentIsFaulted) {
  const Json status = Json::parse(R"({"generation":1,"architecture":"a","components":[
    {"name":"gnss","state":"faulted","fault":"the core threw: no device"}]})");

  EXPECT_NE(render_status(status, {}).find("\ngnss: the core threw: no device\n"),
            std::string::npos);
}

TEST(RenderStatus, SaysWhichJobDoesNotEnd) {
  const Json status = Json::parse(R"({"generation":1,"architecture":"a","components":[
    {"name":"gnss","state":"running","late_ns":2300000000},
    {"name":"laser","state":"running","late_ns":0}]})");

  const std::string text = render_status(status, {});

  EXPECT_NE(text.find("\ngnss: its job should have ended 2.3 s ago\n"), std::string::npos) << text;
  EXPECT_EQ(text.find("laser:"), std::string::npos);
}

TEST(RenderStatus, SaysWhatIsPoisonedAndWhichThreadsAreAbandoned) {
  const Json status = Json::parse(R"({"generation":1,"architecture":"a","components":[],
    "poisoned":["meter"],
    "abandoned_threads":[{"hook":"first.core on_configure","since":"2026-01-01T00:00:00Z"},
                   {"hook":"","since":"2026-01-01T00:00:01Z"}]})");

  const std::string text = render_status(status, {});

  EXPECT_NE(text.find("\nmeter: is poisoned: "), std::string::npos) << text;
  EXPECT_NE(text.find("\nabandoned thread: first.core on_configure since 2026-01-01T00:00:00Z\n"),
            std::string::npos);
  EXPECT_NE(text.find("\nabandoned thread: user code since "), std::string::npos);
  EXPECT_EQ(render_status(kStatus, {}).find("abandoned"), std::string::npos);
}

TEST(RenderStatus, SurvivesAnAnswerWithoutAnything) {
  EXPECT_FALSE(render_status(Json::object(), {}).empty());
  EXPECT_FALSE(render_status(Json::array({1}), {}).empty());
}

TEST(RenderReceipt, IsOneSentence) {
  EXPECT_EQ(render_receipt("swapped control", kReceipt, {}),
            "swapped control: pause 38 ns, 0 releases missed (generation 42)\n");
}

TEST(RenderReceipt, SaysWhenTheDiskDidNotTakeIt) {
  EXPECT_EQ(render_receipt("swapped control", receipt_with("saved", false), {}),
            "swapped control: pause 38 ns, 0 releases missed (generation 42, applied but NOT "
            "saved)\n");
}

TEST(RenderReceipt, CountsOverAllComponents) {
  const Json two = Json::parse(R"([{"name": "a", "pause_ns": 38, "missed": 1, "bytes": 0},
                                   {"name": "b", "pause_ns": 1500, "missed": 0, "bytes": 48}])");

  EXPECT_EQ(
      render_receipt("set a.core.x, b.core.x", receipt_with("components", two), {}),
      "set a.core.x, b.core.x: longest pause 1.5 us, 1 release missed, 48 bytes of state kept "
      "(generation 42)\n");
}

TEST(RenderReceipt, SaysThatAStateWasConverted) {
  const Json two = Json::parse(R"([
      {"name": "a", "pause_ns": 38, "missed": 0, "bytes": 16, "converted": "count/1 -> count/2"},
      {"name": "b", "pause_ns": 38, "missed": 0, "bytes": 48}])");

  EXPECT_EQ(render_receipt("reloaded x", receipt_with("components", two), {}),
            "reloaded x: longest pause 38 ns, 0 releases missed, 48 bytes of state kept, state "
            "converted: count/1 -> count/2 (generation 42)\n");
}

TEST(RenderReceipt, NamesTheCoresThatAreStatelessAndSoBeginAnew) {
  const Json three = Json::parse(R"([
      {"name": "drives", "pause_ns": 38, "missed": 0, "bytes": 0, "begins_anew": true},
      {"name": "control", "pause_ns": 38, "missed": 0, "bytes": 48},
      {"name": "lamp", "pause_ns": 38, "missed": 0, "bytes": 0, "begins_anew": true}])");

  EXPECT_EQ(render_receipt("reloaded x", receipt_with("components", three), {}),
            "reloaded x: longest pause 38 ns, 0 releases missed, 48 bytes of state kept, "
            "Stateless, so begun anew: drives, lamp (generation 42)\n");
}

TEST(RenderReceipt, SaysWhenNothingHadToChange) {
  EXPECT_EQ(render_receipt("started control", receipt_with("changed", false), {}),
            "nothing to change (generation 42 still running)\n");
}

TEST(RenderReceipt, SaysWhenItTookSeveralAttempts) {
  EXPECT_EQ(render_receipt("swapped control", receipt_with("attempts", 3), {}),
            "swapped control: pause 38 ns, 0 releases missed, 3 attempts (generation 42)\n");
}

TEST(RenderReceipt, MayBeAboutNoComponent) {
  EXPECT_EQ(render_receipt("connected a to b", receipt_with("components", Json::array()), {}),
            "connected a to b (generation 42)\n");
}

TEST(RenderReceipt, IsBrokenAtSpacesOnATerminal) {
  EXPECT_EQ(render_receipt("swapped control", kReceipt, {40, false}),
            "swapped control: pause 38 ns, 0 releases\n"
            "  missed (generation 42)\n");
}

TEST(RenderPlugin, SaysWhyTheOldCodeStays) {
  const Json result = Json::parse(R"({"plugin": "extra", "generation": 43, "loaded": true,
    "unmapped": false, "why": "a thread-local object is alive"})");

  EXPECT_EQ(render_plugin("reloaded extra", result, {}),
            "reloaded extra (generation 43)\n"
            "  the old code stays in memory: a thread-local object is alive\n");
}

TEST(RenderPlugin, SaysThatTheOldCodeIsGone) {
  const Json result = Json::parse(R"({"plugin": "extra", "generation": 43, "loaded": false,
    "unmapped": true, "why": "", "warnings": []})");

  EXPECT_EQ(render_plugin("unloaded extra", result, {}),
            "unloaded extra, the old code is out of memory (generation 43)\n");
}

TEST(RenderPlugins, SayWhatEachBrings) {
  const Json result = Json::parse(R"({"items": [{"name": "guidance", "version": "1.2.0", "users": 3,
    "file": "/x/guidance.so", "cores": ["guidance/stop", "guidance/finite_time"], "types": [],
    "components": ["guidance/control"], "warnings": ["built with another compiler"]}]})");

  EXPECT_EQ(render_plugins(result, {}),
            "guidance 1.2.0, 3 objects in use\n"
            "  components  control\n"
            "  cores       stop, finite_time\n"
            "warning: guidance: built with another compiler\n");
  EXPECT_EQ(render_plugins(Json::parse(R"({"items": []})"), {}), "none\n");
}

TEST(RenderPlugins, SayWhichBuildRunsAndWhichTheFileHolds) {
  const Json result = Json::parse(R"({"items": [
    {"name": "slip", "version": "1.0.0", "build_id": "9651293e77", "users": 2,
     "build_on_disk": "fa03265388"},
    {"name": "arm", "version": "1.0.0", "build_id": "12ab34cd56", "build_on_disk": null},
    {"name": "demo", "version": "1.0.0", "build_id": "0011223344"}]})");

  EXPECT_EQ(
      render_plugins(result, {}),
      "slip 1.0.0 (build 9651293e), 2 objects in use\n"
      "  its file holds build fa032653, which the next start, or mauvectl reload slip, loads\n"
      "arm 1.0.0 (build 12ab34cd)\n"
      "  no build can be loaded from its file now, so a start would fail: mauvectl reload arm "
      "--dry-run says why\n"
      "demo 1.0.0 (build 00112233)\n");
}

TEST(RenderPlugins, ForAComponentAreTheCoresToSwapIn) {
  const Json result = Json::parse(R"({"items": [{"name": "guidance", "version": "1.2.0",
    "cores": ["guidance/finite_time", "guidance/stop"]}]})");

  EXPECT_EQ(render_plugins_for(result, {}),
            "CORE                  PLUGIN    VERSION\n"
            "guidance/finite_time  guidance  1.2.0\n"
            "guidance/stop         guidance  1.2.0\n");
  EXPECT_EQ(render_plugins_for(Json::parse(R"({"items": []})"), {}), "none\n");
}

TEST(RenderValue, IsOneLineForAScalar) {
  EXPECT_EQ(
      render_value(Json::parse(R"({"address":"a.core.gain","value":0.2,"status":"current"})"), {}),
      "a.core.gain = 0.2\n");
  EXPECT_EQ(
      render_value(Json::parse(R"({"address":"a.read","value":null,"status":"no_data"})"), {}),
      "a.read = - (no_data)\n");
}

TEST(RenderValue, ShowsTheFieldsOfAStructure) {
  EXPECT_EQ(render_value(Json::parse(R"({"address":"fix.read","status":"new_data",
                                         "value":{"latitude":43.5,"mode":3}})"),
                         {}),
            "fix.read (new_data)\n"
            "  latitude  43.5\n"
            "  mode      3\n");
}

TEST(RenderValue, SaysHowOldItIs) {
  EXPECT_EQ(render_value(Json::parse(R"({"address":"a.ports.in","value":0.2,"status":"stale",
                                         "age_ns":2300000000})"),
                         {}),
            "a.ports.in = 0.2 (stale, 2.3 s old)\n");
}

TEST(RenderSample, SaysHowOldAStaleValueIs) {
  EXPECT_EQ(render_sample(Json::parse(R"({"sub":1,"address":"a.ports.in","value":2,"t_ns":0,
                                          "status":"stale","age_ns":60000000})"),
                          {}),
            "    0.000000  a.ports.in  stale     2 (60.0 ms old)\n");
}

TEST(RenderSample, IsOneLineWithItsTime) {
  const Json params = Json::parse(
      R"({"sub":1,"address":"fix.read","value":{"mode":3},"status":"new_data","t_ns":91827000})");

  EXPECT_EQ(render_sample(params, {}), "    0.091827  fix.read  new_data  {mode: 3}\n");
  EXPECT_EQ(render_sample(params, {24, false}), "    0.091827  fix.read …\n");
}

TEST(RenderSample, SaysHowManyWereDropped) {
  EXPECT_EQ(render_sample(Json::parse(R"({"sub":1,"address":"fix.read","count":120})"), {}),
            "    0.000000  fix.read  120 values dropped: this reader was too slow\n");
}

TEST(RenderRecord, IsOneLine) {
  EXPECT_EQ(render_record(Json::parse(R"({"sub":2,"seq":7,"t":"2026-01-01T00:00:00.000Z","t_ns":9,
    "level":"warn","component":"gnss","event":"frame_bad","text":"checksum","fields":{}})"),
                          {}),
            "2026-01-01T00:00:00.000Z  warn   gnss: checksum\n");
}

TEST(RenderList, IsATableWithTheNameFirst) {
  const Json result = Json::parse(R"({"items":[
    {"zone":"b","name":"scan","data":"laser_scan/1","readers":2},
    {"name":"pose","data":"pose2d/1","readers":11,"writers":["a","b"]}]})");

  EXPECT_EQ(render_list(result, {}),
            "NAME  DATA          READERS  WRITERS  ZONE\n"
            "scan  laser_scan/1        2           b\n"
            "pose  pose2d/1           11  [a, b]\n");
}

TEST(RenderList, SaysWhenThereIsNothing) {
  EXPECT_EQ(render_list(Json::parse(R"({"items":[]})"), {}), "none\n");
}

TEST(RenderObject, IndentsWhatIsInside) {
  const Json object = Json::parse(R"({"kind":"component","address":"control",
    "ports":[{"name":"scan","service":"scan.read"}],"task":{"priority":40,"cpus":[1]}})");

  EXPECT_EQ(render_object(object, {}),
            "address  control\n"
            "kind     component\n"
            "ports\n"
            "  NAME  SERVICE\n"
            "  scan  scan.read\n"
            "task\n"
            "  priority  40\n"
            "  cpus      [1]\n");
}

TEST(RenderObject, ShowsTheAgeOfWhatPortsRead) {
  const Json object = Json::parse(R"({"address":"control","ports":[
    {"name":"scan","status":"stale","age_ns":2300000000},{"name":"goal"}]})");

  EXPECT_EQ(render_object(object, {}),
            "address  control\n"
            "ports\n"
            "  NAME  STATUS    AGE\n"
            "  scan  stale   2.3 s\n"
            "  goal\n");
}

TEST(RenderObject, ShowsOfAPropertyWhatIsWorthAColumn) {
  const Json object = Json::parse(R"({"address":"control","properties":[
    {"name":"core.gain","value":0.3,"default":0.2,"min":0,"max":10,
     "unit":"1/s","type":"double","text":"pull"},
    {"name":"fsm.pace","value":"10ms","default":"10ms","min":null,"max":null,
     "unit":"","type":"duration","text":""}]})");

  EXPECT_EQ(render_object(object, {}),
            "address  control\n"
            "properties\n"
            "  NAME       VALUE  DEFAULT  RANGE    UNIT  TEXT\n"
            "  core.gain  0.3        0.2  0 to 10  1/s   pull\n"
            "  fsm.pace   10ms\n");
}

TEST(Render, ShowsRulesWithTheirValuesAndWhyTheyDoNotFire) {
  const Json result = Json::parse(R"({"items":[
    {"name":"gnss_lost","state":"fired","when":"gnss.core.satellites < 4",
     "values":[{"address":"gnss.core.satellites","value":3}],"fired":2,"ago_ns":3200000000,
     "fired_ns":1,"answer":"applied, generation 5","why_not":"fired, to be armed again"},
    {"name":"slow","state":"armed","when":"a.late > 1s and b.state == running",
     "values":[{"address":"a.late","value":"0s"},{"address":"b.state","value":null}],
     "fired":0,"ago_ns":null,"fired_ns":null,"answer":"","why_not":"condition is false"}]})");

  EXPECT_EQ(render_rules(result, {}),
            "NAME       STATE  CONDITION                                       FIRED  LAST       "
            "ANSWER      "
            " "
            "          WHY NOT\n"
            "gnss_lost  fired  gnss.core.satellites < 4 (now 3)                    2  3.2 s ago  "
            "applied, "
            "generation 5  fired, to be armed again\n"
            "slow       armed  a.late > 1s and b.state == running (now 0s, -)      0  never      "
            "                       condition is false\n");
  EXPECT_EQ(render_rules(Json::parse(R"({"items":[]})"), {}), "none\n");
  const std::string one = render_rule(result, {});
  EXPECT_NE(one.find("gnss_lost"), std::string::npos) << one;
  EXPECT_NE(one.find("3.2 s ago"), std::string::npos) << one;
  EXPECT_EQ(one.find("slow"), std::string::npos) << one;
}

TEST(Render, CutsTheLongAnswersOfRulesWhereNoWidthLimitsThem) {
  const std::string answer = "refused: second.core: " + std::string(300, 'x');
  const Json result = {{"items", {{{"name", "loud"}, {"do", nullptr}, {"answer", answer}}}}};

  const std::string table = render_rules(result, {});
  EXPECT_LT(table.find('\n'), 150U) << table;
  EXPECT_NE(table.find("xxx…"), std::string::npos);
  EXPECT_NE(table.find("mauvectl rules NAME prints the texts that are cut\n"), std::string::npos);
  const std::string one = render_rule(result, {});
  EXPECT_NE(one.find(answer), std::string::npos) << one;
  EXPECT_NE(one.find("its own steps"), std::string::npos) << one;
}

TEST(Render, MarksARuleThatALockHolds) {
  const std::string text = render_rules(Json::parse(R"({"items":[{"name":"slow","state":"armed",
    "when":"a.late > 1s","values":[],"fired":0,"answer":"","why_not":"condition is false",
    "held":"everything is locked"}]})"),
                                        {});
  EXPECT_NE(text.find("armed, held"), std::string::npos) << text;
  EXPECT_NE(text.find("everything is locked; condition is false"), std::string::npos) << text;
}

}  // namespace
}  // namespace mauve::ctl
