// SPDX-License-Identifier: LGPL-3.0-or-later
/// component.stop: ends the current job, writes safe values, parks. Served before everything else,
/// also while a long change is prepared.
#include "commands/answer.h"
#include "commands/model.h"

namespace mauve::daemon {

namespace {

Result<std::vector<std::string>> wanted(const Running& running, const Call& call) {
  auto names = texts(call.params, "components");
  const bool all = flag(call.params, "all");
  if (all == !names.empty()) {
    return refuse(Errc::invalid_value, "components",
                  all ? "names components and says all" : "names no component to stop",
                  "either components or all");
  }
  if (all) {
    for (const auto* component : running.architecture.components()) {
      names.push_back(component->name());
    }
  }
  for (const auto& name : names) {
    if (const auto component = find_component(running, name); !component) {
      return component.error();
    }
  }
  return names;
}

/// One that hangs must not keep the others running: each for itself, and the receipts together.
Result<Receipt> stop_one_by_one(Running& running, const std::vector<std::string>& names) {
  Receipt all;
  std::string hanging;
  for (const auto& name : names) {
    const auto one = running.deployer.stop({name});
    if (!one) {
      hanging += (hanging.empty() ? "" : ", ") + name;
      continue;
    }
    all.generation = one->generation;
    all.state = one->state == ChangeState::applied ? ChangeState::applied : all.state;
    all.commit = std::max(all.commit, one->commit);
    all.attempts = std::max(all.attempts, one->attempts);
    all.components.insert(all.components.end(), one->components.begin(), one->components.end());
  }
  if (!hanging.empty()) {
    return refuse(Errc::timed_out, hanging, "did not end its job in time; all others are stopped",
                  "a core that never returns can only be left behind: restart the daemon");
  }
  return all;
}

}  // namespace

Result<Json> stop(Running& running, const Call& call) {
  if (auto met = check_conditions(running, call); !met) {
    return met.error();
  }
  const auto names = wanted(running, call);
  if (!names) {
    return names.error();
  }
  for (const auto& name : *names) {
    ++running.stops[name];
  }
  const bool all = flag(call.params, "all");
  auto receipt = all ? running.deployer.stop_all() : running.deployer.stop(*names);
  if (!receipt && !all && names->size() > 1) {
    receipt = stop_one_by_one(running, *names);
  }
  running.generation = running.deployer.generation();
  if (!receipt) {
    return receipt.error();
  }
  return to_json(*receipt);
}

}  // namespace mauve::daemon
