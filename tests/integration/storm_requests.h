// SPDX-License-Identifier: LGPL-3.0-or-later
/// The system of a storm, and the requests of its users at random.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "storm_orders.h"
#include "trial_daemon.h"

namespace mauve::test {

/// `weak` and `frail` fail while their file is there. `asker` asks to wake `b` and `c` in each job.
inline constexpr const char* kStormy = R"({
  "schema": "mauve/architecture/1", "name": "stormy", "plugins": ["trial"],
  "resources": {
    "signal": { "type": "shared_data", "data": "double" },
    "level":  { "type": "shared_data", "data": "double" }
  },
  "components": {
    "a": { "type": "trial/unit", "properties": { "fsm.period": "4ms" },
           "ports": { "output": "signal.write" }, "task": { "watchdog": "1h" } },
    "b": { "type": "trial/unit", "properties": { "fsm.period": "5ms" },
           "ports": { "input": "signal.read" }, "task": { "watchdog": "1h" } },
    "c": { "type": "trial/unit", "core": "trial/counting", "properties": { "fsm.period": "10ms" },
           "ports": { "input": "signal.read", "output": "level.write" },
           "task": { "watchdog": "1h" } },
    "weak": { "type": "trial/unit", "core": "trial/brittle", "fallback_core": "trial/steady",
              "properties": { "fsm.period": "5ms", "core.until_there": "SIGN/weak" },
              "task": { "watchdog": "1h", "on_fault": "fallback" } },
    "frail": { "type": "trial/unit", "core": "trial/brittle",
               "properties": { "fsm.period": "5ms", "core.until_there": "SIGN/frail" },
               "task": { "watchdog": "1h" } },
    "asker": { "type": "trial/unit", "core": "trial/nagging", "may_request": ["wake"],
               "properties": { "fsm.period": "50ms", "core.transaction": "wake" },
               "task": { "watchdog": "1h" } }
  },
  "transactions": {
    "rest": [{ "stop": "b" }],
    "wake": [{ "start": "b" }, { "start": "c" }],
    "calm": [{ "swap": "b", "core": "trial/steady" }, { "set": "b.core.gain", "value": 1.0 }]
  },
  "rules": [
    { "name": "loud", "when": "a.core.gain > 6", "do": "rest", "cool_down": "50ms" },
    { "name": "quiet", "when": "a.core.gain < 3", "do": "wake", "cool_down": "50ms" },
    { "name": "excited", "when": "b.core.gain > 7", "do": "calm", "cool_down": "50ms" },
    { "name": "tired", "when": "c.core.gain > 7", "do": [{ "stop": "c" }], "cool_down": "50ms" }
  ]
})";

inline Json stormy(const std::string& signs) {
  std::string text(kStormy);
  const std::string sign = "SIGN";
  for (auto at = text.find(sign); at != std::string::npos; at = text.find(sign, at)) {
    text.replace(at, sign.size(), signs);
  }
  return Json::parse(text);
}

/// These may fail by themselves.
inline bool may_fail(const std::string& component) {
  return component == "weak" || component == "frail";
}

/// A request, and its meaning for the oracle.
struct StormRequest {
  std::string method;
  Json params = Json::object();
  std::optional<Order> order = std::nullopt;
  std::int64_t stamp = 0;  ///< the value that it brings; 0: none
  int install = 0;         ///< the build of the plugin to be put in place before; 0: none
};

/// Requests in an order that a seed decides.
class StormRequests {
 public:
  /// `place` tells the values of several users apart.
  StormRequests(Json file, std::uint64_t seed, std::int64_t place)
      : file_(std::move(file)), random_(seed), stamp_(place * 1'000'000) {}

  std::size_t below(std::size_t limit) { return random_() % limit; }

  StormRequest of_operator() {
    const auto kind = below(100);
    if (kind < 20) return stop({component()});
    if (kind < 22) return all("component.stop");
    if (kind < 26) return all("component.start");
    if (kind < 44) return start({component()});
    if (kind < 60) return set();
    if (kind < 69) return swap();
    if (kind < 75) return {"change.undo"};
    if (kind < 84) return {"change.confirm"};
    return steps(kind < 93);
  }
  /// `generations`: those to which it may go back.
  StormRequest of_admin(const std::vector<std::uint64_t>& generations) {
    const auto kind = below(100);
    if (kind < 15) return reload();
    if (kind < 45) return apply();
    if (kind < 65 && !generations.empty()) {
      const auto generation = generations[below(generations.size())];
      return {"config.rollback", {{"generation", generation}, {"state", "drop"}}};
    }
    if (kind < 75) return release();
    if (kind < 85) return {"change.confirm"};
    return set();
  }

 private:
  const std::string& component() {
    static const std::vector<std::string> kNames{"a", "b", "c", "weak", "frail", "asker"};
    return kNames[below(kNames.size())];
  }
  double gain() { return 0.5 * static_cast<double>(below(19)); }
  void judged(Json& params) {
    switch (below(6)) {
      case 0:
        params["probation"] = "off";
        break;
      case 1:
        params["probation"] = std::to_string(1 + below(100));
        break;
      case 2:
        params["confirm_within"] = std::to_string(50 + below(3000)) + "ms";
        break;
      default:
        break;
    }
  }
  static StormRequest order(const std::string& method, const std::set<std::string>& names) {
    const Json which = names.empty() ? Json{{"all", true}} : Json{{"components", names}};
    return {method, which, Order{method == "component.start", names}};
  }
  static StormRequest all(const std::string& method) { return order(method, {}); }
  StormRequest stop(std::set<std::string> names) {
    if (below(4) == 0) names.insert(component());
    return order("component.stop", names);
  }
  StormRequest start(std::set<std::string> names) {
    if (below(4) == 0) names.insert(component());
    return order("component.start", names);
  }
  StormRequest set() {
    const auto name = component();
    Json values = {{name + ".shell.size", ++stamp_}};
    if (below(2) == 0) values[component() + ".core.gain"] = gain();
    if (below(10) == 0) values["nobody.core.gain"] = 1.0;
    Json params = {{"values", values}};
    judged(params);
    return {"param.set", std::move(params), std::nullopt, stamp_};
  }
  StormRequest swap() {
    static const std::vector<std::string> kGood{"trial/steady", "trial/other", "trial/counting"};
    static const std::vector<std::string> kBad{"trial/throwing_job", "trial/refusing",
                                               "trial/brittle", "trial/throwing_hook"};
    const auto name = component();
    const bool bad = name == "weak" && below(2) == 0;
    const auto& cores = bad ? kBad : kGood;
    Json params = {{"component", name}, {"core", cores[below(cores.size())]}, {"state", "drop"}};
    judged(params);
    return {"core.swap", std::move(params)};
  }
  StormRequest steps(bool stops) {
    const auto name = component();
    const char* word = stops ? "stop" : "start";
    Json steps = Json::array({{{word, name}}});
    if (below(2) == 0) {
      const auto address = component() + ".shell.size";
      steps.push_back({{"set", address}, {"value", ++stamp_}});
    }
    if (below(8) == 0) steps.push_back({{"set", "a.core.gain"}, {"value", -1.0}});  // is refused
    Json params = {{"text", steps.dump()}};
    judged(params);
    // A start beside other steps is on probation with them.
    const bool lasts = stops || steps.size() == 1 || params.value("probation", "") == "off";
    return {"change.apply", std::move(params), Order{!stops, {name}, lasts},
            steps.size() > 1 && steps[1]["value"] == stamp_ ? stamp_ : 0};
  }
  StormRequest release() {
    const bool its = below(2) == 0;
    return {"quarantine.release", {{"core", its ? "trial/brittle" : "trial/throwing_job"}}};
  }
  StormRequest reload() {
    Json params = {{"plugin", "trial"}};
    if (below(2) == 0) params["state"] = "drop";
    judged(params);
    return {"plugin.reload", std::move(params), std::nullopt, 0, 1 + static_cast<int>(below(3))};
  }
  StormRequest apply() {
    Json file = file_;
    auto& components = file["components"];
    components[component()]["properties"]["shell.size"] = ++stamp_;
    components["a"]["properties"]["core.gain"] = gain();
    if (below(3) == 0) {
      components["guest"] = components["b"];
    }
    if (below(4) == 0) components[component()]["start"] = false;
    if (below(8) == 0) components["b"]["core"] = "trial/refusing";
    Json params = {{"text", file.dump()}, {"state", "drop"}};
    judged(params);
    return {"architecture.apply", std::move(params), std::nullopt, stamp_};
  }

  const Json file_;
  std::mt19937_64 random_;
  std::int64_t stamp_;
};

}  // namespace mauve::test
