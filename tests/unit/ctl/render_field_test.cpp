// SPDX-License-Identifier: LGPL-3.0-or-later
#include <string>

#include <gtest/gtest.h>

#include "render/render.h"
#include "render/render_field.h"

namespace mauve::ctl {
namespace {

TEST(RenderObject, WritesDurationsInstantsAndSizesWithUnits) {
  const Json object = Json::parse(R"({"address":"heater",
    "counters":{"elapsed_max_ns":50900,"late_ns":0,"next_release_ns":3940000000},
    "task":{"budget":"2ms","deadline":"0s","stack":65536}})");

  EXPECT_EQ(render_object(object, {}),
            "address  heater\n"
            "counters\n"
            "  elapsed_max   50.9 us\n"
            "  late          0 ns\n"
            "  next_release  T0 + 3.940000000 s\n"
            "task\n"
            "  budget    2ms\n"
            "  deadline  none\n"
            "  stack     64KiB\n");
}

TEST(RenderObject, ShowsAStateMachineWithItsWaitsAndSuccessors) {
  const Json object = Json::parse(R"({"address":"heater","machine":{"initial":"heat","states":[
    {"name":"heat","kind":"execution","transitions":[
      {"to":"doze","guarded":true,"guard":"too_warm"},{"to":"pace","guarded":false}]},
    {"name":"pace","kind":"synchronization","wait_ns":10000000,
     "transitions":[{"to":"heat","guarded":false}]}]}})");

  EXPECT_EQ(render_object(object, {}),
            "address  heater\n"
            "machine\n"
            "  initial  heat\n"
            "  NAME  KIND                WAIT  NEXT\n"
            "  heat  execution                 [too_warm] doze, [else] pace\n"
            "  pace  synchronization  10.0 ms  heat\n");
}

TEST(RenderObject, ShowsTheFieldsOfATypeAlsoThoseOfStructuresAndArrays) {
  const Json type = Json::parse(R"({"address": "path/1", "kind": "type", "type": "path/1",
    "bytes": 280, "fields": [
      {"name": "goal", "unit": "", "text": "", "kind": [
        {"name": "x", "kind": "double", "unit": "m", "text": ""}]},
      {"name": "gains", "unit": "", "text": "P, I, D", "kind": {"array": "float", "size": 3}},
      {"name": "points", "unit": "", "text": "", "kind": {"capacity": 8, "array": [
        {"name": "x", "kind": "double", "unit": "m", "text": ""}]}}]})");

  EXPECT_EQ(render_object(type, {}),
            "address  path/1\n"
            "kind     type\n"
            "type     path/1\n"
            "bytes    280\n"
            "fields\n"
            "  NAME        TYPE                           UNIT  TEXT\n"
            "  goal        structure\n"
            "  goal.x      double                         m\n"
            "  gains       array of 3 float                     P, I, D\n"
            "  points      array of at most 8 structures\n"
            "  points[].x  double                         m\n");
}

TEST(RenderField, SaysWhetherAPortHasASafeValue) {
  EXPECT_EQ(field_content({{"safe_value", true}}, "safe_value"), "declared");
  EXPECT_EQ(field_content({{"safe_value", false}}, "safe_value"), "none");
}

TEST(RenderHistory, IsATableOfWhoWhatAndWhy) {
  const Json history = Json::parse(R"({"state_dir": "/s", "items": [
    {"generation": 42, "time": "2026-01-31T12:00:00.123456Z", "uid": 987654, "command": "param.set",
     "changes": "~ a.core.x: 1 -> 2", "reason": "too slow", "mark": "confirmed", "boot": "b"},
    {"generation": 41, "mark": "damaged"}]})");

  EXPECT_EQ(
      render_history(history, {}),
      "GENERATION  TIME                  USER    COMMAND    MARK       CHANGES             REASON\n"
      "        42  2026-01-31 12:00:00Z  987654  param.set  confirmed  ~ a.core.x: 1 -> 2  too "
      "slow\n"
      "        41                                           damaged\n");
}

TEST(RenderHistory, NamesTheUserAndARollbackByMauved) {
  const std::string text = render_history(Json::parse(R"({"state_dir": "/s", "items": [
    {"generation": 42, "time": "2026-01-31T12:00:00.123456Z", "uid": 0, "command": "rolled_back",
     "changes": "", "reason": "", "mark": "confirmed", "boot": "b"}]})"),
                                          {});

  EXPECT_NE(text.find(" root "), std::string::npos) << text;
  EXPECT_NE(text.find("rollback by mauved"), std::string::npos) << text;
}

TEST(RenderHistory, SaysThatNoUserAskedForAChangeByARule) {
  const std::string text = render_history(Json::parse(R"({"state_dir": "/s", "items": [
    {"generation": 42, "time": "2026-01-31T12:00:00.123456Z", "uid": 0, "command": "supervision",
     "changes": "", "reason": "by rule far", "mark": "confirmed", "boot": "b"}]})"),
                                          {});

  EXPECT_NE(text.find(" none "), std::string::npos) << text;
  EXPECT_EQ(text.find("root"), std::string::npos) << text;
}

TEST(RenderHistory, SaysWhenNothingIsKept) {
  EXPECT_EQ(render_history({{"items", Json::array()}, {"state_dir", nullptr}}, {}),
            "nothing is kept: mauved runs without --state-dir\n");
}

}  // namespace
}  // namespace mauve::ctl
