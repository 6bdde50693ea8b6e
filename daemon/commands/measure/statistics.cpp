// SPDX-License-Identifier: LGPL-3.0-or-later
/// stats.get and stats.reset: the times of jobs and states.
#include <algorithm>

#include "base/name.h"
#include "commands/answer.h"
#include "commands/measure/kernel_counts.h"
#include "commands/model.h"
#include "mauve/host/architecture.h"
#include "rt/process/process.h"

namespace mauve::daemon {

namespace {

Json statistics_json(const Distribution& times) {
  const bool none = times.count == 0;
  const auto ns = [none](Duration time) { return none ? Json() : Json(time.count()); };
  return {{"count", times.count},
          {"sum_ns", times.sum.count()},
          {"min_ns", ns(times.min)},
          {"mean_ns", ns(times.mean())},
          {"p50_ns", ns(times.percentile(50))},
          {"p90_ns", ns(times.percentile(90))},
          {"p99_ns", ns(times.percentile(99))},
          {"p99_9_ns", ns(times.percentile(99.9))},
          {"max_ns", ns(times.max)}};
}

Json statistics_json(const TimeTotal& total) {
  return {{"count", total.count},
          {"sum_ns", total.sum.count()},
          {"max_ns", total.count == 0 ? Json() : Json(total.longest.count())}};
}

Json statistics_json(const StateStatistics& state) {
  return {{"name", state.name},
          {"execution", statistics_json(state.execution)},
          {"preempted", statistics_json(state.preempted)}};
}

Json statistics_json(const ComponentStatistics& one, const std::vector<rt::ThreadFacts>& threads) {
  return {{"name", one.name},
          {"core", one.core},
          {"since_ns", one.since == Duration{0} ? Json() : Json(one.since.count())},
          {"budget_ns", one.budget.count()},
          {"missed", one.missed},
          {"overruns", one.overruns},
          {"over_budget", one.over_budget},
          {"over_budget_max_ns", one.over_budget_max.count()},
          {"lateness", statistics_json(one.lateness)},
          {"execution", statistics_json(one.execution)},
          {"preempted", statistics_json(one.preempted)},
          {"response", statistics_json(one.response)},
          {"lock_waits", statistics_json(one.lock_waits)},
          {"kernel", kernel_counts(threads, one.name)}};
}

/// Its states, or the one of this name.
Result<Json> states_of(const ComponentStatistics& one, const std::string& state) {
  Json rows = Json::array();
  std::vector<std::string> names;
  for (const auto& each : one.states) {
    names.push_back(each.name);
    if (state.empty() || each.name == state) {
      rows.push_back(statistics_json(each));
    }
  }
  if (!state.empty() && rows.empty()) {
    return refuse({Errc::unknown_name, "unknown_state"}, one.name + "." + state,
                  "is no execution state", known_names(state, names));
  }
  return rows;
}

/// "control", or a state of it: "control.reach_goal".
Result<Json> statistics_at(const Running& running, const std::string& address) {
  const auto dot = address.find('.');
  const auto component = find_component(running, address.substr(0, dot));
  if (!component) {
    return component.error();
  }
  const auto one = running.deployer.statistics((*component)->name());
  auto states = states_of(one, dot == std::string::npos ? "" : address.substr(dot + 1));
  if (!states) {
    return states.error();
  }
  auto row = statistics_json(one, rt::threads_of("/", "self"));
  row["states"] = *std::move(states);
  return row;
}

}  // namespace

Result<Json> statistics(Running& running, const Call& call) {
  Json rows = Json::array();
  if (const auto address = text_or(call.params, "address"); !address.empty()) {
    auto row = statistics_at(running, address);
    if (!row) {
      return row.error();
    }
    rows.push_back(*std::move(row));
  } else {
    const auto threads = rt::threads_of("/", "self");
    for (const auto& one : running.deployer.statistics()) {
      rows.push_back(statistics_json(one, threads));
    }
  }
  return Json{{"t_ns", running.deployer.clock().now() - running.deployer.t0()},
              {"components", std::move(rows)}};
}

void reset_statistics(Running& running, const CallPtr& call, Ticket /*none*/) {
  const auto wanted = text_or(call->params, "component");
  auto done = check_conditions(running, *call);
  if (done) {
    done = running.deployer.reset_statistics(wanted);
  }
  if (!done) {
    return answer(running, *call, done.error());
  }
  Json names = Json::array();
  for (const auto* component : running.architecture.components()) {
    if (wanted.empty() || component->name() == wanted) {
      names.push_back({{"name", component->name()}});
    }
  }
  answer(running, *call,
         Json{{"components", std::move(names)},
              {"changed", true},
              {"state", "applied"},
              {"generation", running.generation.load()}});
}

}  // namespace mauve::daemon
