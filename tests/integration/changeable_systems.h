// SPDX-License-Identifier: LGPL-3.0-or-later
/// The systems of the change campaign: one of trial components, and the shipped rover.
#pragma once

#include <string>

#include "change_generator.h"
#include "support/temp_dir.h"

namespace mauve::test {

/// Components of 2 to 10 ms on two processors, and "weak", the least urgent one of its processor,
/// which gets the cores that throw and hang. A user may stop "stood" for good.
inline constexpr const char* kChanged = R"({
  "schema": "mauve/architecture/1", "name": "changed", "plugins": ["trial"],
  "resources": {
    "signal": { "type": "shared_data", "data": "double" },
    "level":  { "type": "shared_data", "data": "double" },
    "tally":  { "type": "trial/tally" },
    "meter":  { "type": "trial/meter" }
  },
  "components": {
    "a": { "type": "trial/unit", "properties": { "fsm.period": "2ms" },
           "ports": { "output": "signal.write" },
           "task": { "priority": 80, "cpus": [0], "budget": "200us" } },
    "b": { "type": "trial/unit", "properties": { "fsm.period": "5ms" },
           "ports": { "input": "signal.read", "output": "tally.note" },
           "task": { "priority": 75, "cpus": [1], "budget": "200us" } },
    "c": { "type": "trial/unit", "core": "trial/counting", "properties": { "fsm.period": "10ms" },
           "ports": { "input": "signal.read", "output": "level.write" },
           "task": { "priority": 70, "cpus": [0], "budget": "200us" } },
    "d": { "type": "trial/unit", "properties": { "fsm.period": "4ms" },
           "ports": { "input": "level.read" },
           "task": { "priority": 85, "cpus": [1], "budget": "200us" } },
    "stood": { "type": "trial/unit", "properties": { "fsm.period": "10ms" },
               "ports": { "input": "level.read" },
               "task": { "priority": 50, "cpus": [0], "budget": "200us" } },
    "weak": { "type": "trial/unit", "properties": { "fsm.period": "5ms" },
              "ports": { "input": "level.read", "output": "meter.write" },
              "task": { "priority": 40, "cpus": [1], "budget": "1ms", "watchdog": "20ms" } }
  },
  "transactions": {
    "deaf": [{ "disconnect": "c.ports.input" }],
    "hear": [{ "connect": "c.ports.input", "to": "signal.read" }],
    "calm": [{ "swap": "b", "core": "trial/steady" }, { "set": "b.core.gain", "value": 1.0 }]
  },
  "rules": [
    { "name": "loud", "when": "signal.read > 6", "do": "deaf", "cool_down": "50ms" },
    { "name": "quiet", "when": "signal.read < 3", "do": "hear", "cool_down": "50ms" },
    { "name": "excited", "when": "b.core.gain > 7", "do": "calm", "cool_down": "50ms" }
  ]
})";

inline ChangeableSystem trial_system() {
  using Json = protocol::Json;
  ChangeableSystem system;
  system.file = Json::parse(kChanged);
  const std::vector<Json> gains{0.0, 1.0, 2.5, 4.0, 6.5, 8.0};
  const std::vector<std::string> good{"trial/steady", "trial/other", "trial/counting"};
  // Hooks that take their time or fail, before anything of the change is in force.
  std::vector<std::string> all = good;
  all.insert(all.end(), {"trial/talking", "trial/regressing", "trial/slow", "trial/refusing",
                         "trial/throwing_hook", "trial/crashing_hook", "trial/leaving_hook",
                         "trial/forgetful", "trial/another", "trial/none"});
  for (const std::string name : {"a", "b", "c", "d", "weak"}) {
    system.values[name + ".core.gain"] = gains;
    system.values[name + ".shell.size"] = {7, 8};
    system.cores[name] = name == "weak" ? all : good;
    system.services[name + ".ports.input"] = {"signal.read", "level.read"};
    system.resting.push_back(name);
  }
  system.cores["d"] = all;
  system.services["b.ports.output"] = {"tally.note"};
  system.services["weak.ports.output"] = {"meter.write"};
  system.values["a.fsm.period"] = {"2ms", "3ms"};
  system.values["c.fsm.period"] = {"8ms", "10ms", "20ms"};
  system.values["tally.core.gain"] = gains;
  system.values["tally.shell.size"] = {7, 9};
  system.values["meter.core.breaks_at"] = {4.0, 9.5};
  system.values["nobody.core.gain"] = {1.0};
  system.stopped = "stood";
  system.plugins = {"trial"};
  system.builds = 3;
  system.may_be_more_urgent = true;
  const Json guest = {{"type", "trial/unit"},
                      {"properties", {{"fsm.period", "5ms"}}},
                      {"ports", {{"input", "signal.read"}}},
                      {"task", {{"priority", 60}, {"cpus", {0}}, {"budget", "200us"}}}};
  system.guests = {{"guest", guest}, {"visitor", guest}};
  system.guests["visitor"]["core"] = "trial/counting";
  for (const std::string core :
       {"throwing_job", "throwing_no_text", "throwing_anything", "hungry"}) {
    Json swap = {{"component", "weak"}, {"core", "trial/" + core}};
    if (core == "throwing_no_text") swap["set"] = {{"in_job", true}};
    if (core == "hungry") swap["set"] = {{"uses", "60ms"}};
    system.faults.push_back(
        {{"quarantine.release", {{"core", "trial/" + core}}}, {"core.swap", swap}});
  }
  system.hangs = {{{"component", "weak"}, {"core", "trial/hanging"}}};
  system.excused = {"weak"};
  system.sound = {good.begin(), good.end()};
  return system;
}

/// The shipped file, in which paths are absolute.
inline ChangeableSystem rover_system(const std::string& etc) {
  using Json = protocol::Json;
  ChangeableSystem system;
  std::string text = TempDir::read(etc + "/rover.json");
  const std::string maps = "\"maps/";
  for (std::size_t at = 0; (at = text.find(maps, at)) != std::string::npos; at += etc.size()) {
    text.replace(at, maps.size(), "\"" + etc + "/maps/");
  }
  system.file = Json::parse(text, nullptr, true, true);
  system.file.erase("$schema");
  system.values = {{"control.core.speed", {0.3, 0.45, 0.6}},
                   {"control.core.obstacle_distance", {0.5, 0.55}},
                   {"control.fsm.pace", {"10ms", "20ms"}},
                   {"mission.core.goal", {{{"x", 16.6}, {"y", 7.9}}, {{"x", 1.0}, {"y", 0.0}}}},
                   {"navigation.core.keep_away", {0.5, 0.55}},
                   {"safety.core.stop_distance", {0.35, 0.4}},
                   {"safety.fsm.period", {"10ms", "12ms"}},
                   {"supervisor.fsm.period", {"50ms", "60ms"}},
                   {"world.core.satellites", {3, 8}},
                   {"teleop.core.max_linear", {0.3, 0.4}},
                   {"laser.fsm.breathe", {"4ms", "5ms"}},
                   {"gnss.core.device", {"pty:gnss"}},
                   {"nobody.core.gain", {1.0}}};
  system.cores = {
      {"control",
       {"guidance/finite_time", "guidance/potential_field", "guidance/stop", "guidance/none"}},
      {"gnss", {"drivers/gnss_serial"}},
      {"imu", {"drivers/imu_xbus"}},
      {"laser", {"drivers/hokuyo_scip"}},
      {"base", {"drivers/create_oi"}}};
  system.services = {{"gnss.ports.fix", {"gnss_to_utm.fix", "fix.write"}},
                     {"control.ports.pose", {"localization.pose"}},
                     {"control.ports.scan", {"scan.read"}},
                     {"supervisor.ports.pose", {"localization.pose"}},
                     {"navigation.ports.scan", {"scan.read"}},
                     {"base.ports.odometry", {"odometry.write"}},
                     {"safety.ports.command", {"priority.read"}}};
  for (const auto& [name, component] : system.file["components"].items()) {
    system.resting.push_back(name);
  }
  system.plugins = {"drivers", "guidance", "localization", "safety", "supervision", "teleop"};
  const Json guest = {{"type", "supervision/supervisor"},
                      {"properties", {{"fsm.period", "40ms"}}},
                      {"ports", {{"pose", {{"connect", "localization.pose"}}}}},
                      {"task", {{"priority", 24}, {"budget", "100us"}}}};
  system.guests = {{"guest", guest}};
  return system;
}

}  // namespace mauve::test
