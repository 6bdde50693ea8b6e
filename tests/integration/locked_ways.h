// SPDX-License-Identifier: LGPL-3.0-or-later
/// Every method that can change something, with each kind of difference that it can make. A new
/// method that changes something gets its ways here: locks_test.cpp fails until it has one.
#pragma once

#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "trial_daemon.h"

namespace mauve::test {

/// The differences that a way makes. Locks judge these, and nothing else.
enum Effect : unsigned {
  kNothing = 0,
  kProperty = 1,  ///< another value of a property, also of a fallback core
  kTopology = 2,  ///< anything but values, starts and stops
  kStart = 4,
  kStop = 8,
  kUnreported = 16,  ///< no difference of the architecture, but more than a stop
};

struct Way {
  std::string name;
  std::string method;
  Json params;
  unsigned effect = kNothing;
  std::vector<std::pair<std::string, Json>> before = {};  ///< asked while nothing is locked
  /// Making the elements runs code of plugins, so it is not begun while everything is locked.
  bool not_begun_under_all = false;
};

inline bool is_held(const Way& way, const std::string& lock) {
  if (lock == "params") return (way.effect & kProperty) != 0;
  if (lock == "topology") return (way.effect & kTopology) != 0;
  return lock == "all" && (way.not_begun_under_all || (way.effect & ~unsigned{kStop}) != 0);
}

/// Of a line of an answer.
inline unsigned effect_of(const Json& line) {
  const auto kind = line["kind"].get<std::string>();
  // A core made anew and its state go with the start or the swap that a lock judges.
  if (kind == "state" || (kind == "core" && line["old"] == line["new"])) return 0;
  if (kind == "property") return kProperty;
  if (kind == "start") return line["new"] == true ? kStart : kStop;
  const bool with_values = line["new"].is_object() && line["new"].contains("properties");
  return kind == "fallback_core" && with_values ? kTopology | kProperty : unsigned{kTopology};
}

/// Two components that run, one that is parked, three resources.
inline Json walked() {
  Json file = Json::parse(std::string(kTrial));
  file["components"]["third"] = {{"type", "trial/unit"}, {"start", false}};
  file["resources"]["tally"] = {{"type", "trial/tally"}};
  return file;
}

inline Json text_of(const Json& file) { return {{"text", file.dump()}, {"probation", "off"}}; }

/// `walked()` with one member set at this path, or without it when the value is null.
inline Json file_with(const std::string& path, const Json& value) {
  Json file = walked();
  const Json::json_pointer at(path);
  if (value.is_null()) {
    file[at.parent_pointer()].erase(at.back());
  } else {
    file[at] = value;
  }
  return text_of(file);
}

inline Json set_to(const Json& values) { return {{"values", values}, {"probation", "off"}}; }

inline Json swap_to(const std::string& core, Json more = Json::object()) {
  more.update({{"component", "first"}, {"core", core}, {"probation", "off"}});
  return more;
}

inline Json steps(const std::string& steps) {
  return {{"text", "[" + steps + "]"}, {"probation", "off"}};
}

inline std::vector<Way> ways_of_single_changes() {
  const Json gain = {{"first.core.gain", 3.0}};
  const Json set = {{"set", {{"gain", 3.0}}}};
  const Json set_in_place = {{"set", {{"gain", 3.0}}}, {"in_place", true}};
  return {
      {"a property", "param.set", set_to(gain), kProperty},
      {"a property of a resource", "param.set", set_to({{"tally.core.gain", 2.0}}), kProperty},
      {"a task attribute", "param.set", set_to({{"first.task.budget", "900us"}}), kTopology},
      {"a property and a task attribute", "param.set",
       set_to({{"first.core.gain", 3.0}, {"first.task.budget", "900us"}}), kProperty | kTopology},
      {"a start", "component.start", {{"components", {"third"}}}, kStart},
      {"a start with a fresh core",
       "component.start",
       {{"components", {"third"}}, {"reset", true}},
       kStart},
      {"a stop", "component.stop", {{"components", {"first"}}}, kStop},
      {"another core", "core.swap", swap_to("trial/other"), kTopology},
      {"another core and a property", "core.swap", swap_to("trial/other", set),
       kTopology | kProperty},
      {"the same core and a property", "core.swap", swap_to("trial/steady", set), kProperty},
      {"another core in place", "core.swap", swap_to("trial/other", {{"in_place", true}}),
       kTopology},
      {"another core in place and a property", "core.swap", swap_to("trial/other", set_in_place),
       kTopology | kProperty},
      {"another core and a budget", "core.swap", swap_to("trial/other", {{"budget", "900us"}}),
       kTopology},
      {"a connection",
       "port.connect",
       {{"port", "first.ports.input"}, {"service", "signal.read"}, {"probation", "off"}},
       kTopology},
      {"a disconnection",
       "port.disconnect",
       {{"port", "second.ports.input"}, {"probation", "off"}},
       kTopology},
      {"a value written",
       "service.call",
       {{"service", "count.write"}, {"arguments", {1}}},
       kUnreported},
      {"a core released", "quarantine.release", {{"core", "trial/none"}}, kUnreported}};
}

inline std::vector<Way> ways_of_steps() {
  return {{"steps that set", "change.apply", steps(R"({"set":"first.core.gain","value":3.0})"),
           kProperty},
          {"steps that disconnect", "change.apply", steps(R"({"disconnect":"second.ports.input"})"),
           kTopology},
          {"steps that connect", "change.apply",
           steps(R"({"connect":"first.ports.input","to":"signal.read"})"), kTopology},
          {"steps that swap", "change.apply", steps(R"({"swap":"first","core":"trial/other"})"),
           kTopology},
          {"steps that make the same core anew", "change.apply",
           steps(R"({"swap":"first","core":"trial/steady","state":"drop"})"), kUnreported},
          {"steps that swap and set", "change.apply",
           steps(R"({"swap":"first","core":"trial/other"},{"set":"first.core.gain","value":3.0})"),
           kTopology | kProperty},
          {"steps that start", "change.apply", steps(R"({"start":"third"})"), kStart},
          {"steps that stop", "change.apply", steps(R"({"stop":"first"})"), kStop},
          {"steps that stop and set", "change.apply",
           steps(R"({"stop":"first"},{"set":"second.core.gain","value":3.0})"), kStop | kProperty}};
}

inline std::vector<Way> ways_of_files() {
  const Json fallback = {{"core", "trial/other"}, {"properties", {{"core.gain", 2.0}}}};
  const Json rule = {
      {{"name", "never"}, {"when", "second.core.count < 0"}, {"do", {{{"stop", "first"}}}}}};
  const std::vector<std::tuple<std::string, std::string, Json, unsigned>> files = {
      {"a property", "/components/first/properties/core.gain", 3.0, kProperty},
      {"a task attribute", "/components/first/task", {{"budget", "900us"}}, kTopology},
      {"a connection", "/components/first/ports/input", "signal.read", kTopology},
      {"a core", "/components/first/core", "trial/other", kTopology},
      {"a component that joins", "/components/guest", {{"type", "trial/unit"}}, kTopology},
      {"a component that leaves", "/components/third", nullptr, kTopology},
      {"a resource that joins",
       "/resources/more",
       {{"type", "shared_data"}, {"data", "double"}},
       kTopology},
      {"a resource that leaves", "/resources/count", nullptr, kTopology},
      {"a resource of another type", "/resources/count/data", "double", kTopology},
      {"a lock budget", "/resources/tally/lock_budget", "100us", kTopology},
      {"a value of a resource", "/resources/tally/properties", {{"core.gain", 2.0}}, kProperty},
      {"a value of the shell of a resource",
       "/resources/tally/properties",
       {{"shell.size", 9}},
       kProperty},
      {"a plugin", "/plugins", {"trial", "demo"}, kTopology},
      {"a fallback core", "/components/first/fallback_core", "trial/other", kTopology},
      {"a fallback core with a value", "/components/first/fallback_core", fallback,
       kTopology | kProperty},
      {"a rule", "/rules", rule, kTopology},
      {"a transaction", "/transactions", {{"rest", {{{"stop", "first"}}}}}, kTopology},
      {"a start", "/components/third/start", true, kStart},
      {"a stop", "/components/first/start", false, kStop}};
  std::vector<Way> ways;
  for (const auto& [name, path, value, effect] : files) {
    ways.push_back(
        {"a file with " + name, "architecture.apply", file_with(path, value), effect, {}, true});
  }
  Json permits = walked();
  permits["transactions"] = {{"rest", {{{"stop", "first"}}}}};
  const auto before = text_of(permits);
  permits["components"]["first"]["may_request"] = {"rest"};
  ways.push_back({"a file with a permission",
                  "architecture.apply",
                  text_of(permits),
                  kTopology,
                  {{"architecture.apply", before}}});
  return ways;
}

inline std::vector<Way> ways_of_plugins_and_rollbacks() {
  const Json set_on_probation = {{"values", {{"first.core.gain", 3.0}}},
                                 {"confirm_within", "600s"}};
  const Json cut = {{"port", "second.ports.input"}, {"confirm_within", "600s"}};
  const Json place = {{"component", "first"}, {"core", "trial/other"}, {"in_place", true}};
  const Json place_with_value = {{"component", "first"},
                                 {"core", "trial/other"},
                                 {"in_place", true},
                                 {"set", {{"gain", 3.0}}}};
  const Json back = {{"generation", 1}, {"probation", "off"}};
  const Json none = Json::object();
  return {
      {"a plugin loaded", "plugin.load", {{"plugin", "demo"}}, kTopology},
      {"a plugin unloaded",
       "plugin.unload",
       {{"plugin", "demo"}},
       kTopology,
       {{"plugin.load", {{"plugin", "demo"}}}}},
      {"a plugin reloaded",
       "plugin.reload",
       {{"plugin", "trial"}, {"probation", "off"}},
       kTopology},
      {"a confirmation", "change.confirm", none, kNothing, {{"param.set", set_on_probation}}},
      {"an undo of a property", "change.undo", none, kProperty, {{"param.set", set_on_probation}}},
      {"an undo of a connection", "change.undo", none, kTopology, {{"port.disconnect", cut}}},
      {"an undo of a swap in place", "change.undo", none, kTopology, {{"core.swap", place}}},
      {"an undo of a swap in place with a value",
       "change.undo",
       none,
       kTopology | kProperty,
       {{"core.swap", place_with_value}}},
      {"a rollback of a property",
       "config.rollback",
       back,
       kProperty,
       {{"param.set", set_to({{"first.core.gain", 3.0}})}}},
      {"a rollback of a connection",
       "config.rollback",
       back,
       kTopology,
       {{"port.disconnect", {{"port", "second.ports.input"}, {"probation", "off"}}}}}};
}

inline std::vector<Way> all_ways() {
  std::vector<Way> all;
  for (auto ways : {ways_of_single_changes(), ways_of_steps(), ways_of_files(),
                    ways_of_plugins_and_rollbacks()}) {
    for (Way& way : ways) all.push_back(std::move(way));
  }
  return all;
}

}  // namespace mauve::test
