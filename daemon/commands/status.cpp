// SPDX-License-Identifier: LGPL-3.0-or-later
/// status.get, ping, version: is it well, and what is it?
#include "commands/answer.h"
#include "commands/command.h"
#include "commands/gate.h"
#include "commands/given_up.h"
#include "keeper.h"
#include "mauve/version.h"

namespace mauve::daemon {

namespace {

/// Names of the resources that refuse their users.
Json poisoned(const Running& running) {
  Json names = Json::array();
  for (auto* resource : running.architecture.resources()) {
    if (resource->gate().poisoned()) {
      names.push_back(resource->name());
    }
  }
  return names;
}

}  // namespace

Result<Json> ping(Running& /*running*/, const Call& /*call*/) { return Json{{"pong", true}}; }

Result<Json> version(Running& running, const Call& /*call*/) {
  return Json{{"server", std::string("mauved ") + kVersion},
              {"version", kVersion},
              {"protocol", {protocol::kVersion}},
              {"abi", kAbi},
              {"boot", running.boot}};
}

Result<Json> status(Running& running, const Call& /*call*/) {
  Json rows = Json::array();
  for (const auto& one : running.deployer.status()) {
    Json row = {{"name", one.name},
                {"type", one.type},
                {"core", one.core},
                {"fsm_state", one.fsm_state},
                {"state", to_string(one.state)},
                {"priority", one.priority},
                {"cpus", one.cpus},
                {"realtime", one.realtime},
                {"changing", one.changing},
                {"releases", one.releases},
                {"missed", one.missed},
                {"overruns", one.overruns},
                {"over_budget", one.over_budget},
                {"late_ns", one.late.count()},
                {"lateness_max_ns", one.lateness_max.count()},
                {"execution_max_ns", one.execution_max.count()}};
    if (!one.fault.empty()) {
      row["fault"] = one.fault;
    }
    if (one.state == ComponentState::faulted) {
      row["hint"] = "mauvectl start " + one.name;
    }
    rows.push_back(std::move(row));
  }
  const std::chrono::duration<double> up = std::chrono::steady_clock::now() - running.since;
  Json result = {{"generation", running.earlier + running.deployer.generation()},
                 {"architecture", running.architecture.name()},
                 {"uptime_s", up.count()},
                 {"realtime", running.deployer.realtime()},
                 {"lock", to_string(running.lock)},
                 {"components", std::move(rows)},
                 {"poisoned", poisoned(running)},
                 {"left_behind", left_behind(running)}};
  if (running.keeper != nullptr) {
    result["saved"] = running.keeper->saved();
  }
  return result;
}

}  // namespace mauve::daemon
