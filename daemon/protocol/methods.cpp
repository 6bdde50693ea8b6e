// SPDX-License-Identifier: LGPL-3.0-or-later
#include "protocol/methods.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "base/name.h"

namespace mauve::protocol {
namespace {

using enum JsonType;

constexpr Param kAddress[] = {{"address", string, true}};
constexpr Param kAddresses[] = {{"addresses", strings, true}};
constexpr Param kFor[] = {{"for", string}};
constexpr Param kOfComponent[] = {{"component", string}};
constexpr Param kOneComponent[] = {{"component", string, true}};
constexpr Param kRule[] = {{"rule", string}};
constexpr Param kSub[] = {{"sub", integer, true}};
constexpr Param kCore[] = {{"core", string, true}};
constexpr Param kSet[] = {{"values", object, true}, {"dry_run", boolean},
                          {"state", string},        {"probation", string},
                          {"misses", string},       {"confirm_within", string}};
constexpr Param kStart[] = {
    {"components", strings}, {"all", boolean}, {"reset", boolean}, {"dry_run", boolean}};
constexpr Param kStop[] = {{"components", strings}, {"all", boolean}, {"dry_run", boolean}};
constexpr Param kSwap[] = {
    {"component", string, true}, {"core", string, true},    {"set", object},
    {"budget", string},          {"in_place", boolean},     {"state", string},
    {"defaults", boolean},       {"dry_run", boolean},      {"probation", string},
    {"misses", string},          {"confirm_within", string}};
constexpr Param kConnect[] = {{"port", string, true}, {"service", string, true},
                              {"max_age", string},    {"replace", boolean},
                              {"dry_run", boolean},   {"probation", string},
                              {"misses", string},     {"confirm_within", string}};
constexpr Param kDisconnect[] = {{"port", string, true},
                                 {"dry_run", boolean},
                                 {"probation", string},
                                 {"misses", string},
                                 {"confirm_within", string}};
constexpr Param kPlugin[] = {{"plugin", string, true}};
constexpr Param kLoad[] = {{"plugin", string, true}, {"dry_run", boolean}};
constexpr Param kReload[] = {{"plugin", string, true},   {"state", string},
                             {"probation", string},      {"misses", string},
                             {"confirm_within", string}, {"dry_run", boolean}};
constexpr Param kCheck[] = {{"text", string, true}, {"file", string}};
constexpr Param kDiff[] = {{"text", string, true}, {"file", string}};
constexpr Param kApply[] = {{"text", string, true}, {"file", string},
                            {"dry_run", boolean},   {"state", string},
                            {"sync", string},       {"probation", string},
                            {"misses", string},     {"confirm_within", string}};
constexpr Param kSteps[] = {{"text", string, true},    {"file", string},      {"dry_run", boolean},
                            {"state", string},         {"probation", string}, {"misses", string},
                            {"confirm_within", string}};
constexpr Param kCall[] = {{"service", string, true}, {"arguments", array}};
constexpr Param kCondition[] = {{"condition", string, true}};
constexpr Param kHistory[] = {{"n", integer}};
constexpr Param kCompare[] = {{"from", integer, true}, {"to", integer, true}};
constexpr Param kUndo[] = {{"dry_run", boolean}};
constexpr Param kRollback[] = {{"generation", integer, true},
                               {"dry_run", boolean},
                               {"state", string},
                               {"sync", string},
                               {"probation", string},
                               {"misses", string},
                               {"confirm_within", string}};
constexpr Param kTraceStart[] = {{"detail", boolean}, {"seconds", integer}};
constexpr Param kTraceRead[] = {
    {"recording", string}, {"from", integer}, {"count", integer}, {"now", boolean}};
constexpr Param kLock[] = {{"lock", string, true}};
constexpr Param kTail[] = {{"component", string}, {"level", string}, {"n", integer},
                           {"follow", boolean},   {"since", string}, {"grep", string}};
constexpr Param kSetLevel[] = {{"level", string, true}, {"component", string}, {"for", string}};
constexpr Param kStats[] = {{"address", string}};
constexpr Param kEveryMutation[] = {
    {"if_generation", integer}, {"reason", string}, {"deadline_ms", integer}};

constexpr Method kMethods[] = {
    {"ping", "answers at once", {}, false, true, false, true},
    {"version", "server, protocol and plugin ABI", {}},
    {"status.get", "generation and one row a component (alias: status)", {}},
    {"component.list", "all components", {}},
    {"resource.list", "all resources", {}},
    {"service.list", "services of the resources, with kinds and types", {}},
    {"fsm.list", "state machines of the loaded plugins", {}},
    {"type.list",
     "kinds of components and resources, and types of data, of the loaded plugins",
     {}},
    {"core.list", "cores of the loaded plugins, or those that fit a component", kFor},
    {"port.list", "ports and what they are connected to", kOfComponent},
    {"plugin.list", "plugins loaded, or those with cores for a component", kFor},
    {"client.list", "who is connected", {}},
    {"command.list", "this table", {}},
    {"system.analyze", "response times, slack and what is not proved", {}},
    {"stats.get", "what jobs and states took, of all components or one", kStats},
    {"metrics.get", "state and statistics in the text format of Prometheus", {}},
    {"stats.reset", "counts anew what jobs take", kOfComponent, true, false, true},
    {"rules.list", "state, last firing and why not, of all rules or one", kRule},
    {"daemon.doctor", "rights of the daemon's process, its threads and directories", {}},
    {"object.get", "everything about one object", kAddress},
    {"component.why", "its last failure: what, why, what was done, what to do", kOneComponent},
    {"param.get", "value and status of one address", kAddress},
    {"condition.get", "what a condition, as of a rule, says now", kCondition},
    {"param.set", "sets properties in one change", kSet, true},
    {"watch.subscribe", "every new value of the addresses", kAddresses},
    {"watch.unsubscribe", "ends a watch or a log", kSub},
    {"component.start", "starts at the next instant of the grid", kStart, true},
    {"component.stop", "ends the job, writes safe values, parks", kStop, true, true, false, true},
    {"core.swap", "replaces the core of a component", kSwap, true},
    {"port.connect", "connects a port to a service", kConnect, true},
    {"port.disconnect", "disconnects a port", kDisconnect, true},
    {"change.apply", "several steps at one instant, as those of a transaction", kSteps, true},
    {"service.call", "writes to, calls or fires a service", kCall, true},
    {"change.confirm", "the change on probation stays", {}, true, false, false, true},
    {"change.undo", "back to before the change on probation", kUndo, true, false, false, true},
    {"quarantine.list", "cores that were rolled back, and why", {}},
    {"quarantine.release", "lets a core be used again", kCore, true},
    {"plugin.load", "loads a plugin by name", kLoad, true},
    {"plugin.unload", "unloads a plugin that nothing uses", kPlugin, true},
    {"plugin.reload", "moves every instance to the new code", kReload, true},
    {"config.get", "the running system as an architecture file", {}},
    {"config.check", "all errors of an architecture file", kCheck},
    {"architecture.graph", "elements, ports, services and connections, in one look", {}},
    {"architecture.diff", "what another architecture file would change", kDiff},
    {"architecture.apply", "the running system becomes that of a file, or nothing happens", kApply,
     true},
    {"config.history", "the saved generations, newest first", kHistory},
    {"config.compare", "what differs between two saved generations", kCompare},
    {"config.rollback", "back to a saved generation", kRollback, true},
    {"lock.set", "none, params, topology or all: what may not be changed", kLock, true, false,
     true},
    {"log.level", "from which level on is logged, where, and how long still", {}},
    {"log.set_level", "of all or of one component, for a time", kSetLevel, true, false, true},
    {"log.tail", "the last records, and those to come", kTail},
    {"trace.start", "begins to trace, or begins anew", kTraceStart},
    {"trace.stop", "ends the trace, which can still be read", {}},
    {"trace.status", "whether it is on, and how much there is", {}},
    {"trace.read", "a page of the trace, or of a flight recording", kTraceRead},
    {"trace.list", "flight recordings", {}},
};

bool fits(const Json& value, JsonType type) {
  switch (type) {
    case string:
      return value.is_string();
    case boolean:
      return value.is_boolean();
    case integer:
      return value.is_number_unsigned() || (value.is_number_integer() && value >= 0);
    case object:
      return value.is_object();
    case array:
      return value.is_array();
    case strings:
      return value.is_array() && std::all_of(value.begin(), value.end(),
                                             [](const Json& item) { return item.is_string(); });
  }
  return false;
}

std::string_view words_for(JsonType type) {
  switch (type) {
    case string:
      return "a string";
    case boolean:
      return "true or false";
    case integer:
      return "an integer of 0 or more";
    case object:
      return "an object";
    case array:
      return "an array";
    case strings:
      return "an array of strings";
  }
  return "something else";
}

std::vector<Param> params_of(const Method& method) {
  std::vector<Param> all(method.params.begin(), method.params.end());
  if (method.mutation) all.insert(all.end(), std::begin(kEveryMutation), std::end(kEveryMutation));
  return all;
}

Fault unknown_argument(const Method& method, const std::string& name,
                       const std::vector<Param>& known) {
  std::vector<std::string> names;
  for (const Param& param : known) names.emplace_back(param.name);
  return fault_of(kInvalidParams, "unknown argument '" + name.substr(0, 64) + "'",
                  std::string(method.name), did_you_mean(name, names, "'"));
}

}  // namespace

std::span<const Method> methods() { return kMethods; }

const Method* find_method(std::string_view name) {
  if (name == "status") name = "status.get";
  const auto found = std::find_if(std::begin(kMethods), std::end(kMethods),
                                  [&](const Method& method) { return method.name == name; });
  return found == std::end(kMethods) ? nullptr : found;
}

Fault unknown_method(std::string_view name) {
  std::vector<std::string> names;
  for (const Method& method : kMethods) names.emplace_back(method.name);
  std::string hint = did_you_mean(name, names, "'");
  if (hint.empty()) hint = "command.list shows all methods";
  return fault_of(kUnknownMethod, "unknown method '" + std::string(name.substr(0, 64)) + "'", {},
                  std::move(hint));
}

std::optional<Fault> check_params(const Method& method, const Json& params) {
  const auto known = params_of(method);
  for (const auto& [name, value] : params.items()) {
    const auto param = std::find_if(known.begin(), known.end(),
                                    [&key = name](const Param& one) { return one.name == key; });
    if (param == known.end()) return unknown_argument(method, name, known);
    if (fits(value, param->type)) continue;
    return fault_of(kInvalidParams,
                    "argument '" + name + "' must be " + std::string(words_for(param->type)),
                    std::string(method.name));
  }
  for (const Param& param : known) {
    if (!param.required || params.contains(param.name)) continue;
    return fault_of(kInvalidParams, "argument '" + std::string(param.name) + "' is missing",
                    std::string(method.name));
  }
  return std::nullopt;
}

}  // namespace mauve::protocol
