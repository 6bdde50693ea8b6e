// SPDX-License-Identifier: LGPL-3.0-or-later
/// Requests for changes of all kinds in an order that a seed decides. Answers do not matter to it:
/// the same seed gives the same requests, whatever becomes of them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "protocol/message.h"

namespace mauve::test {

/// A system, and what may be changed of it.
struct ChangeableSystem {
  using Json = protocol::Json;

  Json file;                                                 ///< the architecture as it begins
  std::map<std::string, std::vector<Json>> values;           ///< by address
  std::map<std::string, std::vector<std::string>> cores;     ///< by component
  std::map<std::string, std::vector<std::string>> services;  ///< by port
  std::vector<std::string> resting;    ///< components that may stand for a while
  std::string stopped;                 ///< a component that a user stops, and no request names
  std::vector<std::string> plugins;    ///< that are reloaded
  std::map<std::string, Json> guests;  ///< components that join and leave
  std::vector<std::vector<std::pair<std::string, Json>>> faults;  ///< changes that end badly
  std::vector<Json> hangs;  ///< swaps to cores that do not return; few, each costs a thread
  std::vector<std::string> excused;  ///< whose own faults cost them releases
  std::set<std::string> sound;       ///< cores that never fail by themselves
  bool may_be_more_urgent = false;   ///< by 2, and no two of a CPU are nearer to each other
  int builds = 1;                    ///< of the plugins
};

/// One request on the wire.
struct ChangeRequest {
  using Json = protocol::Json;

  std::string method;
  Json params = Json::object();
  int install = 0;  ///< put this build of the plugin in place before; 0: none
  int back = -1;    ///< the generation so many behind the newest is `generation`; -1: none

  [[nodiscard]] Json to_json() const {
    Json json = {{"method", method}, {"params", params}};
    if (install != 0) json["install"] = install;
    if (back >= 0) json["back"] = back;
    return json;
  }
};

class ChangeGenerator {
 public:
  using Json = protocol::Json;

  ChangeGenerator(ChangeableSystem system, std::uint64_t seed)
      : system_(std::move(system)), random_(seed) {}

  [[nodiscard]] ChangeRequest next() {
    if (!waiting_.empty()) {
      auto request = std::move(waiting_.front());
      waiting_.erase(waiting_.begin());
      return request;
    }
    make();
    return next();
  }

 private:
  void make() {
    const std::size_t kind = below(100);
    if (kind < 22) return add("param.set", {{"values", some_values(1 + below(3))}}, true);
    if (kind < 36) return add("core.swap", some_swap(), true);
    if (kind < 40) return swap_in_place();
    if (kind < 54) return connect_or_not();
    if (kind < 66) return add("architecture.apply", {{"text", some_file().dump()}}, true);
    if (kind < 69) return add("architecture.apply", barrier());
    if (kind < 71) return add("architecture.apply", dry_run());
    if (kind < 74) return reload();
    if (kind < 78) return roll_back();
    if (kind < 82) return add("change.undo");
    if (kind < 85) return add("change.confirm");
    if (kind < 96) return stop_and_start();
    if (kind < 97) return lock_for_a_while();
    fail();
  }

  void add(const std::string& method, Json params = Json::object(), bool probation = false) {
    if (probation) params.update(some_probation());
    waiting_.push_back({method, std::move(params)});
  }

  Json some_probation() {
    switch (below(8)) {
      case 0:
        return {{"probation", "off"}};
      case 1:
        return {{"probation", std::to_string(1 + below(200))}};
      case 2:
        return {{"confirm_within", std::to_string(20 + below(300)) + "ms"}};
      default:
        return Json::object();
    }
  }
  Json some_values(std::size_t count) {
    Json values = Json::object();
    for (; count > 0; --count) {
      const auto& [address, choices] = one_of(system_.values);
      values[address] = one_of(choices);
    }
    return values;
  }
  Json some_swap() {
    const auto& [component, cores] = one_of(system_.cores);
    Json swap = {{"component", component}, {"core", one_of(cores)}};
    if (below(4) == 0) swap["state"] = "drop";
    return swap;
  }
  void swap_in_place() {
    auto swap = some_swap();
    swap["in_place"] = true;
    add("core.swap", std::move(swap));
  }
  void connect_or_not() {
    const auto& [port, services] = one_of(system_.services);
    add("port.disconnect", {{"port", port}}, true);
    if (below(4) > 0) add("port.connect", {{"port", port}, {"service", one_of(services)}}, true);
  }
  Json barrier() { return {{"text", some_file().dump()}, {"sync", "barrier"}}; }
  Json dry_run() { return {{"text", some_file().dump()}, {"dry_run", true}}; }
  void reload() {
    Json params = {{"plugin", one_of(system_.plugins)}};
    if (below(2) == 0) params["state"] = "drop";
    add("plugin.reload", std::move(params));
    const auto build = 1 + below(static_cast<std::size_t>(system_.builds));
    if (system_.builds > 1) waiting_.back().install = static_cast<int>(build);
  }
  void roll_back() {
    Json params = Json::object();
    if (below(2) == 0) params["state"] = "drop";
    add("config.rollback", std::move(params));
    waiting_.back().back = static_cast<int>(below(12));
  }
  void stop_and_start() {
    const auto& component = one_of(system_.resting);
    if (below(3) == 0) add("component.stop", {{"components", Json::array({component})}});
    add("component.start", {{"components", Json::array({component})}, {"reset", below(2) == 0}});
  }
  void lock_for_a_while() {
    add("lock.set", {{"lock", below(2) == 0 ? "params" : "all"}});
    add("param.set", {{"values", some_values(1)}});
    add("lock.set", {{"lock", "none"}});
  }
  void fail() {
    constexpr int kMostHangs = 40;
    if (!system_.hangs.empty() && below(10) == 0 && hangs_ < kMostHangs) {
      ++hangs_;
      const auto& swap = one_of(system_.hangs);
      add("quarantine.release", {{"core", swap["core"]}});
      add("core.swap", swap);
      return;
    }
    if (system_.faults.empty()) return make();
    for (const auto& [method, params] : one_of(system_.faults)) add(method, params);
  }

  /// The file of the beginning, with other values, cores, task attributes, guests.
  Json some_file() {
    Json file = system_.file;
    auto& components = file["components"];
    for (std::size_t i = below(4); i > 0; --i) {
      const auto& [address, choices] = one_of(system_.values);
      const auto dot = address.find('.');
      const auto owner = address.substr(0, dot);
      auto& of = components.contains(owner) ? components[owner] : file["resources"][owner];
      of["properties"][address.substr(dot + 1)] = one_of(choices);
    }
    if (below(3) == 0) {
      const auto& [component, cores] = one_of(system_.cores);
      components[component]["core"] = one_of(cores);
    }
    if (below(2) == 0) change_a_task(components);
    for (const auto& [name, guest] : system_.guests) {
      if (below(2) == 0) components[name] = guest;
    }
    return file;
  }
  /// Priorities stay in their order: check-trace knows those of the end only.
  void change_a_task(Json& components) {
    auto component = components.begin();
    std::advance(component, below(components.size()));
    auto& task = (*component)["task"];
    if (below(2) == 0) task["offset"] = std::to_string(below(4)) + "ms";
    if (below(2) == 0) task["deadline"] = "2ms";
    const int more = static_cast<int>(below(3));
    if (system_.may_be_more_urgent) task["priority"] = task.value("priority", 10) + more;
  }

  std::size_t below(std::size_t limit) { return random_() % limit; }
  template <typename Choices>
  const typename Choices::value_type& one_of(const Choices& choices) {
    return *std::next(choices.begin(), static_cast<std::ptrdiff_t>(below(choices.size())));
  }

  ChangeableSystem system_;
  std::mt19937_64 random_;
  std::vector<ChangeRequest> waiting_;
  int hangs_ = 0;
};

}  // namespace mauve::test
