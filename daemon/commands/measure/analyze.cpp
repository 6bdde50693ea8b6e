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

/// The costs that all of it assumes, and the noise that probes measure.
Json machine_of(const Timing& timing) {
  const auto& assumed = timing.machine;
  Json measured = Json::array();
  for (const auto& one : timing.noise) {
    measured.push_back({{"cpu", one.cpu},
                        {"span_ns", one.span.count()},
                        {"count", one.late.count},
                        {"p50_ns", one.late.percentile(50).count()},
                        {"p99_ns", one.late.percentile(99).count()},
                        {"p99_9_ns", one.late.percentile(99.9).count()},
                        {"max_ns", one.late.max.count()},
                        {"beyond", one.beyond},
                        {"worst_ns", one.worst.count()},
                        {"worst_ago_ns", one.worst_ago.count()}});
  }
  return {{"assumed",
           {{"wake_ns", assumed.wake.count()},
            {"switch_ns", assumed.activation.count()},
            {"timer_ns", assumed.interrupt.count()},
            {"kernel_ns", assumed.kernel.count()},
            {"window_ns", MachineCosts::window.count()}}},
          {"measured", std::move(measured)}};
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
    locks.push_back({{"resource", one.resource},
                     {"lock_budget_ns", optional_ns(one.lock_budget)},
                     {"source", one.source}});
  }
  return Json{{"components", std::move(rows)},
              {"locks", std::move(locks)},
              {"cpus", std::move(cpus)},
              {"factor", timing.factor ? Json(*timing.factor) : Json()},
              {"problems", timing.problems},
              {"notes", timing.notes},
              {"contradictions", timing.contradictions},
              {"machine", machine_of(timing)}};
}

}  // namespace mauve::daemon
