// SPDX-License-Identifier: LGPL-3.0-or-later
#include "arch/parse/parse.h"

#include <random>
#include <string>

#include <gtest/gtest.h>

namespace mauve::arch {
namespace {

constexpr std::string_view kRover = R"({
  "$schema": "architecture.schema.json",
  "schema": "mauve/architecture/1",
  "name": "rover",  // the paper's robot
  "plugins": ["types", "drivers", "guidance"],
  "resources": {
    "scan":    { "type": "shared_data", "data": "laser_scan/1" },
    "log":     { "type": "ring_buffer", "data": "laser_scan/1", "cross_core": true },
    "pose":    { "type": "localization/ekf", "properties": { "core.process_noise": 0.05 },
                 "ports": { "scan": "scan.read" } }
  },
  "components": {
    "laser":   { "type": "drivers/laser_sim", "ports": { "scan": "scan.write" },
                 "properties": { "fsm.period": "25ms" }, "task": { "priority": 60, "cpus": [1] } },
    "control": { "type": "guidance/control", "core": "guidance/potential_field",
                 "fsm": "guidance/control_fsm",
                 "properties": { "core.gain": 0.2, "fsm.pace": "10ms" },
                 "ports": { "pose": { "connect": "pose.predict", "max_age": "50ms" },
                            "scan": "scan.read" },
                 "task": { "priority": 40, "cpus": [1, 2], "offset": "1ms", "deadline": "8ms",
                           "budget": "2ms", "stack": "128KiB", "on_overrun": "stop",
                           "overrun_limit": 3 },
                 "start": false }
  }
})";

Spec spec_of(std::string_view text) {
  Problems problems;
  auto spec = parse(text, problems);
  for (const Problem& problem : problems.sorted()) ADD_FAILURE() << to_string(problem, "text");
  return spec ? *spec : Spec{};
}

std::vector<Problem> problems_of(std::string_view text) {
  Problems problems;
  static_cast<void>(parse(text, problems));
  return problems.sorted();
}

// The rover with one piece of its text replaced.
std::string rover_with(std::string_view what, std::string_view by) {
  std::string text(kRover);
  const std::size_t found = text.find(what);
  EXPECT_NE(found, std::string::npos) << what;
  return text.replace(found, what.size(), by);
}

TEST(Parse, ReadsAWholeArchitecture) {
  const Spec spec = spec_of(kRover);

  EXPECT_EQ(spec.name, "rover");
  ASSERT_EQ(spec.plugins.size(), 3U);
  EXPECT_EQ(spec.plugins[2].value, "guidance");
  ASSERT_EQ(spec.resources.size(), 3U);
  EXPECT_EQ(spec.resources[0].name, "scan");
  EXPECT_EQ(spec.resources[0].data->value, "laser_scan/1");
  EXPECT_TRUE(spec.resources[1].cross_core);
  EXPECT_EQ(spec.resources[2].properties[0].value, Value(0.05));
  EXPECT_EQ(spec.resources[2].connections[0].service, "scan.read");
}

TEST(Parse, ReadsHowLongAResourceIsHeld) {
  const Spec spec = spec_of(R"({"schema": "mauve/architecture/1", "name": "held",
    "resources": {"pose": {"type": "a/b", "lock_budget": "50us"}, "log": {"type": "a/b"}}})");

  EXPECT_EQ(spec.resources.at(0).lock_budget->value, 50us);
  EXPECT_FALSE(spec.resources.at(1).lock_budget);
}

TEST(Parse, ReadsAllOfAComponent) {
  const ComponentSpec control = spec_of(kRover).components.at(1);

  EXPECT_EQ(control.name, "control");
  EXPECT_EQ(control.where, (Position{15, 5}));
  EXPECT_EQ(control.type.value, "guidance/control");
  EXPECT_EQ(control.core->value, "guidance/potential_field");
  EXPECT_EQ(control.fsm->value, "guidance/control_fsm");
  EXPECT_EQ(control.properties[1].name, "fsm.pace");
  EXPECT_EQ(control.properties[1].value, Value("10ms"));
  EXPECT_EQ(control.connections[0].port, "pose");
  EXPECT_EQ(control.connections[0].service, "pose.predict");
  EXPECT_EQ(control.connections[0].max_age, Duration{50'000'000});
  EXPECT_EQ(control.connections[1].max_age, std::nullopt);
  EXPECT_FALSE(control.start);
}

TEST(Parse, ReadsAllTaskAttributes) {
  const TaskSpec task = spec_of(kRover).components.at(1).task;

  EXPECT_EQ(task.priority->value, 40);
  EXPECT_EQ(task.cpus.value, (std::vector<int>{1, 2}));
  EXPECT_EQ(task.offset->value, Duration{1'000'000});
  EXPECT_EQ(task.deadline->value, Duration{8'000'000});
  EXPECT_EQ(task.budget->value, Duration{2'000'000});
  EXPECT_EQ(task.stack->value, 131072U);
  EXPECT_EQ(task.on_overrun->value, OnOverrun::stop);
  EXPECT_EQ(task.overrun_limit->value, 3U);
}

TEST(Parse, ReadsWhatIsDoneWhenACoreFails) {
  const Spec spec = spec_of(R"({"schema": "mauve/architecture/1", "name": "cautious",
    "components": {
      "plain": { "type": "a/b", "fallback_core": "a/stop", "task": { "on_fault": "fallback",
                 "on_overrun": "fallback", "overrun_limit": 2, "watchdog": "50ms" } },
      "full": { "type": "a/b", "fallback_core": { "core": "a/slow",
                "properties": { "core.gain": 0.1 } },
                "task": { "on_fault": { "restart": 5, "per": "2s", "back_off": "0ms" } } }}})");

  const ComponentSpec& plain = spec.components.at(0);
  EXPECT_EQ(plain.fallback->core.value, "a/stop");
  EXPECT_EQ(plain.task.on_fault->value.action, FaultPolicy::Action::fallback);
  EXPECT_EQ(plain.task.on_overrun->value, OnOverrun::fallback);
  EXPECT_EQ(plain.task.overrun_limit->value, 2U);
  EXPECT_EQ(plain.task.watchdog->value, 50ms);
  const ComponentSpec& full = spec.components.at(1);
  EXPECT_EQ(full.fallback->core.value, "a/slow");
  EXPECT_EQ(full.fallback->properties.at(0).name, "core.gain");
  const FaultPolicy expected{FaultPolicy::Action::restart, 5, 2s, 0ms};
  EXPECT_EQ(full.task.on_fault->value, expected);
}

TEST(Parse, LeavesOutWhatTheFileLeavesOut) {
  const Spec spec = spec_of(R"({"schema": "mauve/architecture/1", "name": "empty",
                                 "components": {"idle": {"type": "a/b"}}})");

  const ComponentSpec& idle = spec.components.at(0);
  EXPECT_FALSE(idle.core);
  EXPECT_FALSE(idle.task.priority);
  EXPECT_TRUE(idle.task.cpus.value.empty());
  EXPECT_TRUE(idle.start);
}

struct WrongText {
  std::string what, by, at, message, hint;
  std::uint32_t line;
};

const WrongText kWrongTexts[] = {
    {"\"plugins\"", "\"plugin\"", "", "unknown key \"plugin\"", "did you mean \"plugins\"?", 5},
    {"\"priority\": 60", "\"prioritty\": 60", "laser.task", "unknown key \"prioritty\"",
     "did you mean \"priority\"?", 14},
    {"\"priority\": 60", "\"priority\": 9223372036854775808", "laser.task.priority",
     "9223372036854775808 is not from 1 to 90", "", 14},
    {"\"priority\": 60", "\"priority\": 0", "laser.task.priority", "0 is not from 1 to 90", "", 14},
    {"\"priority\": 60", "\"priority\": 91", "laser.task.priority", "91 is not from 1 to 90", "",
     14},
    {"\"priority\": 60", "\"priority\": \"60\"", "laser.task.priority",
     "expected an integer, got a string", "", 14},
    {"[1] }", "[] }", "laser.task.cpus", "names no CPU",
     "leave \"cpus\" out to let the deployer choose", 14},
    {"[1, 2]", "[1, 1]", "control.task.cpus", "CPU 1 appears twice", "", 20},
    {"\"8ms\"", "8", "control.task.deadline", "expected a duration, got an integer",
     "write a number and a unit as text, such as \"10ms\"", 20},
    {"\"8ms\"", "\"8\"", "control.task.deadline", "\"8\" has no unit",
     "write a number and a unit, such as \"10ms\" (ns, us, ms, s, min, h)", 20},
    {"\"8ms\"", "\"0ms\"", "control.task.deadline", "must be over 0", "", 20},
    {"\"128KiB\"", "\"1KiB\"", "control.task.stack", "\"1KiB\" is not from 16KiB to 64MiB", "", 21},
    {"\"on_overrun\": \"stop\"", "\"on_overrun\": \"stopp\"", "control.task.on_overrun",
     "\"stopp\" is not one of catch_up, skip, stop, fallback", "did you mean \"stop\"?", 21},
    {"\"on_overrun\": \"stop\"", "\"on_overrun\": \"skip\"", "control.task.overrun_limit",
     "has no meaning here", "it belongs to \"on_overrun\": \"stop\" and \"fallback\"", 22},
    {"\"on_overrun\": \"stop\"", "\"on_overrun\": \"fallback\"", "control.task.on_overrun",
     "\"fallback\" needs a fallback core",
     "write \"fallback_core\": \"plugin/name\" beside \"task\"", 21},
    {"\"priority\": 60", "\"on_fault\": \"fallback\"", "laser.task.on_fault",
     "\"fallback\" needs a fallback core",
     "write \"fallback_core\": \"plugin/name\" beside \"task\"", 14},
    {"\"priority\": 60", "\"on_fault\": \"restart\"", "laser.task.on_fault",
     "\"restart\" is not one of stop, fallback, { \"restart\": N }",
     "write \"on_fault\": { \"restart\": 3, \"per\": \"60s\" } to restart it", 14},
    {"\"priority\": 60", "\"on_fault\": \"falback\"", "laser.task.on_fault",
     "\"falback\" is not one of stop, fallback, { \"restart\": N }",
     "did you mean \"fallback\"? Or write \"on_fault\": { \"restart\": 3, \"per\": \"60s\" } to "
     "restart it",
     14},
    {"\"priority\": 60", "\"on_fault\": 3", "laser.task.on_fault",
     "expected \"stop\", \"fallback\" or an object, got an integer",
     "write \"on_fault\": { \"restart\": 3, \"per\": \"60s\" } to restart it", 14},
    {"\"priority\": 60", "\"on_fault\": { \"per\": \"60s\" }", "laser.task.on_fault",
     "\"restart\" is missing", "write \"restart\": 3", 14},
    {"\"priority\": 60", "\"on_fault\": { \"restart\": 0 }", "laser.task.on_fault.restart",
     "0 is not from 1 to 1000000000", "", 14},
    {"\"priority\": 60", "\"on_fault\": { \"restart\": 1, \"per\": \"0s\" }",
     "laser.task.on_fault.per", "must be over 0", "", 14},
    {"\"priority\": 60", "\"on_fault\": { \"restart\": 1, \"backoff\": \"0s\" }",
     "laser.task.on_fault", "unknown key \"backoff\"", "did you mean \"back_off\"?", 14},
    {"\"priority\": 60", "\"watchdog\": \"0s\"", "laser.task.watchdog", "must be over 0", "", 14},
    {"\"start\": false", "\"fallback_core\": 1", "control.fallback_core",
     "expected a string, got an integer", "", 23},
    {"\"start\": false", "\"fallback_core\": {}", "control.fallback_core", "\"core\" is missing",
     "write \"core\": \"plugin/name\"", 23},
    {"\"start\": false",
     "\"fallback_core\": { \"core\": \"a/b\", \"properties\": { \"fsm.pace\": 1 } }",
     "control.fallback_core.fsm.pace", "not the name of a property",
     "write the part and the name, such as \"core.gain\"; there is: core", 23},
    {"\"scan\": \"scan.write\"", "\"scan\": \"scan\"", "laser.ports.scan",
     "\"scan\" is not a service", "write the resource and its service, such as \"scan.read\"", 13},
    {"\"scan\": \"scan.write\"", "\"scan\": 3", "laser.ports.scan",
     "expected \"resource.service\" or an object, got an integer",
     "write \"scan\": \"resource.service\"", 13},
    {"\"connect\": \"pose.predict\", ", "", "control.ports.pose", "\"connect\" is missing",
     "write \"connect\": \"resource.service\"", 18},
    {"\"core.gain\"", "\"gain\"", "control.gain", "not the name of a property",
     "write the part and the name, such as \"core.gain\"; there is: shell, core, fsm", 17},
    {"\"core.gain\"", "\"cor.gain\"", "control.cor.gain", "not the name of a property",
     "write the part and the name, such as \"core.gain\"; did you mean \"core\"?", 17},
    {"\"core.gain\": 0.2", "\"core.gain\": null", "control.core.gain", "has no value", "", 17},
    {"\"type\": \"drivers/laser_sim\", ", "", "laser", "\"type\" is missing",
     "write \"type\": \"plugin/name\"", 13},
    {"\"drivers/laser_sim\"", "\"drivers/../laser\"", "laser.type",
     "\"drivers/../laser\" is not a valid name here",
     "write \"plugin/name\", or a built-in: shared_data, ring_buffer", 13},
    {"\"laser\":", "\"Laser\":", "Laser", "\"Laser\" is not a name",
     "names are lower-case letters, digits and '_', start with a letter and have at most 64 "
     "characters",
     13},
    {"\"laser\":", "\"scan\":", "scan", "a resource has this name already", "it is in line 7", 13},
    {"\"drivers\",", "\"types\",", "plugins", "\"types\" appears twice", "", 5},
    {"\"drivers\",", "\"/tmp/evil.so\",", "plugins", "\"/tmp/evil.so\" is not a valid name here",
     "plugins are named, without path or \".so\"", 5},
    {"architecture/1", "architecture/2", "schema",
     "this version of mauve reads \"mauve/architecture/1\" only", "", 3},
    {"\"start\": false", "\"start\": 0", "control.start", "expected true or false, got an integer",
     "", 23},
    {"\"data\": \"laser_scan/1\" }", "\"data\": \"laser scan\" }", "scan.data",
     "\"laser scan\" is not a valid name here", "write name and revision, such as \"velocity/1\"",
     7},
    {"\"cross_core\": true", "\"lock_budget\": \"0us\"", "log.lock_budget", "must be over 0", "",
     8},
    {"\"cross_core\": true", "\"lock_budget\": \"-1us\"", "log.lock_budget", "\"-1us\" is negative",
     "write a number and a unit, such as \"10ms\" (ns, us, ms, s, min, h)", 8},
    {"\"cross_core\": true", "\"lock_budget\": \"50\"", "log.lock_budget", "\"50\" has no unit",
     "write a number and a unit, such as \"10ms\" (ns, us, ms, s, min, h)", 8},
    {"\"cross_core\": true", "\"lock_budget\": 50", "log.lock_budget",
     "expected a duration, got an integer", "write a number and a unit as text, such as \"10ms\"",
     8},
    {"\"cross_core\": true", "\"lock_budget\": \"1001ms\"", "log.lock_budget",
     "is longer than callers wait for a resource",
     "declare the longest time that one call takes, at most 1s", 8},
    {"\"data\": \"laser_scan/1\" }", "\"data\": \"laser_scan/1\", \"lock_budget\": \"1us\" }",
     "scan.lock_budget", "has no meaning here: shared_data is held for some stores only",
     "remove this key", 7}};

TEST(Parse, RefusesEachMistakeWithItsPlaceAddressAndHint) {
  for (const WrongText& wrong : kWrongTexts) {
    const auto problems = problems_of(rover_with(wrong.what, wrong.by));
    ASSERT_EQ(problems.size(), 1U) << wrong.by;
    EXPECT_EQ(problems[0].error.at, wrong.at) << wrong.by;
    EXPECT_EQ(problems[0].error.message, wrong.message);
    EXPECT_EQ(problems[0].error.hint, wrong.hint);
    EXPECT_EQ(problems[0].where.line, wrong.line) << wrong.by;
  }
}

TEST(Parse, OffersNoKeyThatItRefuses) {
  const auto problems = problems_of(
      rover_with("\"data\": \"laser_scan/1\" }", "\"data\": \"laser_scan/1\", \"hold\": 3 }"));
  ASSERT_EQ(problems.size(), 1U);
  EXPECT_NE(problems[0].error.hint.find("lock_budget"), std::string::npos);
  EXPECT_EQ(problems[0].error.hint.find("on_fault"), std::string::npos) << problems[0].error.hint;
}

TEST(Parse, ReportsAllMistakesAtOnceInTheOrderOfTheFile) {
  std::string text = rover_with("\"priority\": 60", "\"priority\": 600");
  text.replace(text.find("\"budget\""), 8, "\"budgett\"");
  text.replace(text.find("shared_data"), 11, "shared data");

  const auto problems = problems_of(text);

  ASSERT_EQ(problems.size(), 3U);
  EXPECT_EQ(problems[0].error.at, "scan.type");
  EXPECT_EQ(problems[1].error.at, "laser.task.priority");
  EXPECT_EQ(problems[2].error.at, "control.task");
}

TEST(Parse, WantsSchemaAndName) {
  const auto problems = problems_of("{}");

  ASSERT_EQ(problems.size(), 2U);
  EXPECT_EQ(problems[0].error.message, "\"schema\" is missing");
  EXPECT_EQ(problems[1].error.message, "\"name\" is missing");
}

TEST(Parse, RefusesWhatIsNoObject) {
  EXPECT_EQ(problems_of("[]")[0].error.message, "expected an object, got an array");
  EXPECT_EQ(
      problems_of(rover_with("[\"types\", \"drivers\", \"guidance\"]", "{}"))[0].error.message,
      "expected an array, got an object");
}

TEST(Parse, PrintsAProblemAsFileLineColumn) {
  const auto problems = problems_of(rover_with("\"priority\": 60", "\"priority\": 0"));

  ASSERT_EQ(problems.size(), 1U);
  EXPECT_EQ(to_string(problems[0], "rover.json"),
            "rover.json:14:80: laser.task.priority: 0 is not from 1 to 90");
}

// Any damage is either accepted or reported with a line; nothing crashes and nothing is silent.
TEST(Parse, SurvivesRandomDamageAndAlwaysNamesALine) {
  const std::string_view pieces[] = {"{",  "}",    "[",    "]",       "\"",    ":",
                                     ",",  "null", "1e9",  "-1",      "\"x\"", "true",
                                     "//", "\n",   "\xff", "\\u0000", "core.", "{}"};
  std::mt19937 random(11);
  for (int round = 0; round < 5'000; ++round) {
    std::string text(kRover);
    for (auto change = random() % 3 + 1; change > 0; --change) {
      const std::size_t where = random() % text.size();
      const std::size_t length = random() % 8;
      text.replace(where, std::min(length, text.size() - where),
                   pieces[random() % std::size(pieces)]);
    }
    Problems problems;
    const auto spec = parse(text, problems);
    ASSERT_TRUE(spec || !problems.empty()) << text;
    for (const Problem& problem : problems.sorted()) ASSERT_GT(problem.where.line, 0U) << text;
  }
}

}  // namespace
}  // namespace mauve::arch
