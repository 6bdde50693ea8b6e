// SPDX-License-Identifier: LGPL-3.0-or-later
// The differences of elements that stay: properties, cores, connections, attributes.
#include "arch/compare/diff.h"

#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "unit/arch/diff_fixture.h"

namespace mauve::arch {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST_F(Diff, SaysNothingAboutTheSameFile) {
  const Difference difference = to(sample::kArchitecture);

  EXPECT_THAT(said(difference.lines), IsEmpty());
  EXPECT_TRUE(empty(difference.change));
  EXPECT_TRUE(difference.change.fallbacks.empty());
}

TEST_F(Diff, FindsAPropertyOfTheCore) {
  const Difference difference = to_with("\"core.gain\": 0.5", "\"core.gain\": 0.75");

  EXPECT_THAT(said(difference.lines), ElementsAre("~ property left.core.gain: 0.5 -> 0.75"));
  const Edit& edit = only_edit(difference);
  EXPECT_EQ(edit.member, "left");
  EXPECT_THAT(said(edit.properties), ElementsAre("core.gain=0.75"));
  EXPECT_FALSE(edit.core || edit.fsm || edit.task || edit.type);
}

TEST_F(Diff, TakesAPropertyThatIsNotInTheFileAsItsDefault) {
  const Difference difference = to_with("\"core.gain\": 0.5, ", "");

  EXPECT_THAT(said(difference.lines), ElementsAre("~ property left.core.gain: 0.5 -> 0.2"));
  EXPECT_THAT(said(only_edit(difference).properties), ElementsAre("core.gain=0.2"));
}

TEST_F(Diff, ComparesPropertiesByValue) {
  EXPECT_TRUE(empty(to_with("\"core.gain\": 0.5", "\"core.gain\": 5e-1").change));
  EXPECT_TRUE(empty(to_with("\"25ms\"", "\"0.025s\"").change));
  EXPECT_TRUE(empty(to_with("\"x\": 1,", "\"x\": 1.0,").change));
}

TEST_F(Diff, FindsPropertiesOfShellAndStateMachine) {
  std::string text = sample::with("/dev/left", "/dev/other");
  text = sample::with("\"25ms\"", "\"20ms\"", text);

  const Difference difference = to(text);

  EXPECT_THAT(said(difference.lines),
              ElementsAre("~ property left.shell.device: \"/dev/left\" -> \"/dev/other\"",
                          "~ property left.fsm.period: \"25ms\" -> \"20ms\""));
  EXPECT_THAT(said(only_edit(difference).properties),
              ElementsAre("shell.device=\"/dev/other\"", "fsm.period=\"20ms\""));
}

TEST_F(Diff, GivesAnotherCoreAllThatDiffersFromItsDefaults) {
  std::string text = sample::with("\"type\": \"sample/control\",",
                                  "\"type\": \"sample/control\", \"core\": \"sample/repel\",");
  text = sample::with("\"core.gain\": 0.5", "\"core.distance\": 0.9", text);
  text = sample::with(",\n                               \"core.home\": { \"x\": 1, \"y\": 2.5 }",
                      "", text);

  const Difference difference = to(text);

  EXPECT_THAT(said(difference.lines),
              ElementsAre("~ core left.core: \"sample/attract\" -> \"sample/repel\"",
                          "+ property left.core.distance: 0.9"));
  const Edit& edit = only_edit(difference);
  ASSERT_TRUE(edit.core);
  EXPECT_EQ(edit.core->name, "sample/repel");
  EXPECT_THAT(said(edit.properties), ElementsAre("core.distance=0.9"));
}

TEST_F(Diff, RepeatsWhatAFreshCoreWouldForgetWithoutCallingItADifference) {
  running_ = made(sample::kArchitecture);
  // The same property in another core: as after `swap-core` to a core with a gain of its own.
  ASSERT_TRUE(running_->find_component("left")->replace_core(CoreType::of<sample::Eager>("eager")));
  ASSERT_TRUE(running_->find_component("left")->core().find_property("gain")->set(0.5));
  wanted_ = made(sample::kArchitecture);

  const Difference difference = compare(*running_, *wanted_);

  EXPECT_THAT(said(difference.lines),
              ElementsAre("~ core left.core: \"eager\" -> \"sample/attract\"",
                          "+ property left.core.home: {\"x\":1,\"y\":2.5}"));
  EXPECT_THAT(said(only_edit(difference).properties),
              ElementsAre("core.gain=0.5", "core.home={\"x\":1,\"y\":2.5}"));
}

TEST_F(Diff, KeepsTheValuesThatAnotherStateMachineTakesOver) {
  const Difference difference = to_with("\"type\": \"sample/control\",",
                                        "\"type\": \"sample/control\", \"fsm\": \"sample/slow\",");

  EXPECT_THAT(said(difference.lines),
              ElementsAre("~ fsm left.fsm: \"sample/control\" -> \"sample/slow\""));
  const Edit& edit = only_edit(difference);
  ASSERT_TRUE(edit.fsm);
  EXPECT_EQ(edit.fsm->name, "sample/slow");
  EXPECT_THAT(edit.properties, IsEmpty());
}

TEST_F(Diff, SetsBackWhatAnotherStateMachineWouldTakeOver) {
  std::string text = sample::with("\"type\": \"sample/control\",",
                                  "\"type\": \"sample/control\", \"fsm\": \"sample/slow\",");
  text = sample::with(", \"fsm.period\": \"25ms\"", "", text);

  const Difference difference = to(text);

  EXPECT_THAT(said(difference.lines),
              ElementsAre("~ fsm left.fsm: \"sample/control\" -> \"sample/slow\"",
                          "~ property left.fsm.period: \"25ms\" -> \"10ms\""));
  EXPECT_THAT(said(only_edit(difference).properties), ElementsAre("fsm.period=\"10ms\""));
}

TEST_F(Diff, FindsConnectionsThatComeGoAndMove) {
  std::string text = sample::with("\"scan\": \"scan.read\", ", "");
  text = sample::with("relay.write", "pose.write", text);
  text = sample::with("\"50ms\"", "\"60ms\"", text);
  text = sample::with("\"start\": false",
                      "\"start\": false, \"ports\": { \"scan\": \"scan.read\" }", text);

  const Difference difference = to(text);

  EXPECT_THAT(said(difference.lines),
              ElementsAre("~ port left.ports.pose: {\"connect\":\"pose.read\",\"max_age\":\"50ms\"}"
                          " -> {\"connect\":\"pose.read\",\"max_age\":\"60ms\"}",
                          "- port left.ports.scan: \"scan.read\"",
                          "~ port left.ports.command: \"relay.write\" -> \"pose.write\"",
                          "+ port right.ports.scan: \"scan.read\""));
  ASSERT_EQ(difference.change.edits.size(), 2U);
  const Edit& left = difference.change.edits[0];
  EXPECT_THAT(left.disconnect, ElementsAre("pose", "scan", "command"));
  EXPECT_THAT(said(left.connect), ElementsAre("pose=pose.read/60000000", "command=pose.write/0"));
  EXPECT_THAT(said(difference.change.edits[1].connect), ElementsAre("scan=scan.read/0"));
}

TEST_F(Diff, FindsConnectionsAndPropertiesOfResources) {
  std::string text = sample::with("\"next\": \"pose.write\"", "");
  text = sample::with("\"core.capacity\": 16", "\"core.capacity\": 8", text);

  const Difference difference = to(text);

  EXPECT_THAT(said(difference.lines), ElementsAre("~ property scan.core.capacity: 16 -> 8",
                                                  "- port relay.ports.next: \"pose.write\""));
  ASSERT_EQ(difference.change.edits.size(), 2U);
  EXPECT_EQ(difference.change.edits[0].member, "scan");
  EXPECT_THAT(said(difference.change.edits[0].properties), ElementsAre("core.capacity=8"));
  EXPECT_EQ(difference.change.edits[1].member, "relay");
  EXPECT_THAT(difference.change.edits[1].disconnect, ElementsAre("next"));
}

TEST_F(Diff, FindsEveryTaskAttributeAndGivesAllOfThem) {
  std::string text = sample::with("\"priority\": 60, \"cpus\": [0], ", "");
  text = sample::with("\"offset\": \"1ms\", \"deadline\": \"8ms\"", "\"offset\": \"2ms\"", text);
  text = sample::with("\"budget\": \"2ms\", \"stack\": \"128KiB\", \"on_overrun\": \"stop\"",
                      "\"watchdog\": \"50ms\", \"on_fault\": { \"restart\": 2 }, "
                      "\"on_overrun\": \"fallback\"",
                      text);
  text = sample::with("\"task\"", "\"fallback_core\": \"sample/repel\", \"task\"", text);

  const Difference difference = to(text);

  EXPECT_THAT(said(difference.lines),
              ElementsAre("+ fallback_core left.fallback_core: \"sample/repel\"",
                          "~ task left.task.priority: 60 -> 10", "- task left.task.cpus: [0]",
                          "~ task left.task.offset: \"1ms\" -> \"2ms\"",
                          "- task left.task.deadline: \"8ms\"", "- task left.task.budget: \"2ms\"",
                          "~ task left.task.stack: \"128KiB\" -> \"64KiB\"",
                          "~ task left.task.on_overrun: \"stop\" -> \"fallback\"",
                          "~ task left.task.on_fault: \"stop\" -> "
                          "{\"restart\":2,\"per\":\"60s\",\"back_off\":\"100ms\"}",
                          "+ task left.task.watchdog: \"50ms\""));
  const Edit& edit = only_edit(difference);
  ASSERT_TRUE(edit.task);
  EXPECT_EQ(edit.task->watchdog, 50ms);
  EXPECT_EQ(edit.task->overrun_limit, 3U);
  EXPECT_EQ(edit.task->on_fault.restarts, 2U);
}

TEST_F(Diff, FindsWhatStartsAndWhatParks) {
  const Difference starts = to_with("\"start\": false", "\"start\": true");
  EXPECT_THAT(said(starts.lines), ElementsAre("~ start right.start: false -> true"));
  EXPECT_EQ(only_edit(starts).mode, Mode::run);

  const Difference parks = to_with("\"task\"", "\"start\": false, \"task\"");
  EXPECT_THAT(said(parks.lines), ElementsAre("~ start left.start: true -> false"));
  EXPECT_EQ(only_edit(parks).mode, Mode::park);
}

TEST_F(Diff, LooksAtWhatIsParkedNowAndNotAtWhatTheFileSaid) {
  const Difference difference =
      to(sample::kArchitecture, [](const ComponentBase& one) { return one.name() == "left"; });

  EXPECT_THAT(said(difference.lines), ElementsAre("~ start left.start: false -> true",
                                                  "~ start right.start: true -> false"));
}

TEST_F(Diff, FindsFallbackCoresAndTheirProperties) {
  const Difference comes =
      to_with("\"task\"",
              "\"fallback_core\": { \"core\": \"sample/repel\", \"properties\": "
              "{ \"core.distance\": 1 } }, \"task\"");

  EXPECT_THAT(said(comes.lines),
              ElementsAre("+ fallback_core left.fallback_core: {\"core\":\"sample/repel\","
                          "\"properties\":{\"core.distance\":1}}"));
  ASSERT_EQ(comes.change.fallbacks.size(), 1U);
  EXPECT_EQ(comes.change.fallbacks[0].component, "left");
  EXPECT_EQ(comes.change.fallbacks[0].fallback->core.name, "sample/repel");
  EXPECT_TRUE(only_edit(comes).task) << "no generation without a member";

  running_->find_component("left")->fall_back_to(comes.change.fallbacks[0].fallback);
  wanted_ = made(sample::kArchitecture);
  const Difference goes = compare(*running_, *wanted_);
  EXPECT_EQ(goes.lines.at(0).op, Line::Op::remove);
  ASSERT_EQ(goes.change.fallbacks.size(), 1U);
  EXPECT_FALSE(goes.change.fallbacks[0].fallback);
}

TEST_F(Diff, FindsHowLongAResourceIsHeld) {
  const Difference longer = to_with("\"lock_budget\": \"50us\"", "\"lock_budget\": \"1.5ms\"");
  EXPECT_THAT(said(longer.lines),
              ElementsAre("~ lock_budget relay.lock_budget: \"50us\" -> \"1.5ms\""));
  EXPECT_EQ(only_edit(longer).member, "relay");
  EXPECT_EQ(only_edit(longer).lock_budget, 1500us);

  const Difference withdrawn = to_with(", \"lock_budget\": \"50us\"", "");
  EXPECT_THAT(said(withdrawn.lines), ElementsAre("- lock_budget relay.lock_budget: \"50us\""));
  EXPECT_EQ(only_edit(withdrawn).lock_budget, 0us);
}

TEST_F(Diff, ShowsAnotherNameOfTheArchitectureAndChangesNothingForIt) {
  const Difference difference = to_with("\"name\": \"sample\"", "\"name\": \"simple\"");

  EXPECT_THAT(said(difference.lines), ElementsAre("~ architecture name: \"sample\" -> \"simple\""));
  EXPECT_TRUE(empty(difference.change));
}

TEST_F(Diff, IsNotMisledByTheOrderOfTheFile) {
  std::string text =
      sample::with("\"pose\":  { \"type\": \"shared_data\", \"data\": \"pose/1\" },\n", "");
  text = sample::with("\"relay\": {",
                      "\"pose\": { \"type\": \"shared_data\", \"data\": \"pose/1\" }, \"relay\": {",
                      text);

  EXPECT_TRUE(empty(to(text).change));
}

TEST(SameValue, ComparesNumbersByValueAtAnyDepth) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::int64_t large = (std::int64_t{1} << 60);

  EXPECT_TRUE(same_value(1, 1.0));
  EXPECT_FALSE(same_value(std::int64_t{INT64_MAX}, std::uint64_t{INT64_MAX} + 1));
  EXPECT_TRUE(same_value(Value::Array{1, 2.5}, Value::Array{1.0, 2.5}));
  EXPECT_TRUE(same_value(Value::Object{{"x", 1}}, Value::Object{{"x", 1.0}}));
  EXPECT_TRUE(same_value(nan, nan));
  EXPECT_TRUE(same_value(Value(), Value()));
  EXPECT_FALSE(same_value(Value(), 0));
  EXPECT_FALSE(same_value(large, large + 1));
  EXPECT_FALSE(same_value(Value::Array{1}, Value::Array{1, 2}));
  EXPECT_FALSE(same_value(Value::Object{{"x", 1}}, Value::Object{{"y", 1}}));
  EXPECT_FALSE(same_value("1", 1));
}

}  // namespace
}  // namespace mauve::arch
