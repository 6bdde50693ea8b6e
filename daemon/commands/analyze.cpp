// SPDX-License-Identifier: LGPL-3.0-or-later
/// system.analyze: does every job meet its deadline, and by how much?
#include "commands/command.h"

namespace mauve::daemon {
namespace {

Json optional_ns(const std::optional<Duration>& duration) {
  return duration ? Json(duration->count()) : Json();
}

Json row_of(const ComponentTiming& one) {
  return {{"name", one.name},
          {"cpu", one.cpu ? Json(*one.cpu) : Json()},
          {"priority", one.priority},
          {"execution_ns", one.execution.count()},
          {"source", one.source},
          {"blocking_ns", one.blocking.count()},
          {"deadline_ns", one.deadline.count()},
          {"response_ns", optional_ns(one.response)},
          {"slack_ns", optional_ns(one.slack)},
          {"problem", one.problem}};
}

}  // namespace

Result<Json> analyze(Running& running, const Call& /*call*/) {
  const Timing timing = running.deployer.analyze();
  Json rows = Json::array();
  for (const auto& one : timing.components) {
    rows.push_back(row_of(one));
  }
  Json cpus = Json::array();
  for (const auto& one : timing.cpus) {
    cpus.push_back({{"cpu", one.cpu}, {"load", one.load}, {"overloaded", one.overloaded}});
  }
  Json locks = Json::array();
  for (const auto& one : timing.locks) {
    locks.push_back(
        {{"resource", one.resource}, {"hold_ns", optional_ns(one.hold)}, {"source", one.source}});
  }
  return Json{
      {"components", std::move(rows)}, {"locks", std::move(locks)},
      {"cpus", std::move(cpus)},       {"factor", timing.factor ? Json(*timing.factor) : Json()},
      {"problems", timing.problems},   {"notes", timing.notes}};
}

}  // namespace mauve::daemon
