// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/notice.h"

#include <chrono>
#include <set>
#include <utility>

#include "commands/quarantine.h"

namespace mauve::daemon {

namespace {

Reaction reaction_of(Outcome::Kind kind) {
  if (kind == Outcome::Kind::rolled_back) {
    return Reaction::rolled_back;
  }
  if (kind == Outcome::Kind::gave_up) {
    return Reaction::parked;
  }
  return kind == Outcome::Kind::fell_back ? Reaction::fell_back : Reaction::restarted;
}

Failure failure_now(const Running& running) {
  Failure failure;
  failure.time = logging::utc(std::chrono::system_clock::now());
  failure.monotonic_ns = running.deployer.clock().now();
  return failure;
}

/// "threw: sensor lost" tells the cause first; a text alone does not.
void split_reason(const std::string& reason, bool has_cause, Failure& failure) {
  const auto colon = has_cause ? reason.find(": ") : std::string::npos;
  if (has_cause) {
    failure.cause = reason.substr(0, colon);
  }
  failure.text = !has_cause                   ? reason
                 : colon == std::string::npos ? std::string()
                                              : reason.substr(colon + 2);
}

}  // namespace

void remember_cores(Running& running) {
  std::set<std::string> names;
  for (const auto* component : running.architecture.components()) {
    names.insert(component->name());
    const auto& core = component->bundle()->core_type.name;
    running.failures.runs(component->name(), {core, build_of(running, core)});
  }
  running.failures.keep_only(names);
}

void notice(Running& running, const Outcome& outcome) {
  using Kind = Outcome::Kind;
  const bool fails =
      !outcome.component.empty() && outcome.kind != Kind::passed && outcome.kind != Kind::overtaken;
  if (fails) {
    auto failure = failure_now(running);
    const bool rolled_back = outcome.kind == Kind::rolled_back;
    split_reason(outcome.reason, rolled_back, failure);
    failure.culprit = running.failures.running(outcome.component);
    if (rolled_back && !outcome.cores.empty()) {
      failure.culprit = {outcome.cores.front(), build_of(running, outcome.cores.front())};
    }
    failure.reaction = reaction_of(outcome.kind);
    failure.generation = outcome.began;
    failure.generation_after = outcome.generation;
    if (outcome.kind == Kind::gave_up) {
      // It is about to be seen parked: that is this failure, not another one.
      const auto status = running.deployer.status(outcome.component);
      static_cast<void>(running.failures.parks(outcome.component, status.releases));
    }
    if (const auto* component = running.architecture.find_component(outcome.component)) {
      failure.core_after = component->bundle()->core_type.name;
      failure.state_after = to_string(running.deployer.status(outcome.component).state);
    }
    running.failures.note(outcome.component, std::move(failure));
  }
  remember_cores(running);
}

void notice_parked(Running& running) {
  for (const auto& one : running.deployer.status()) {
    if (one.state != ComponentState::faulted || !running.failures.parks(one.name, one.releases)) {
      continue;
    }
    auto failure = failure_now(running);
    failure.text = one.fault;
    failure.culprit = {one.core, build_of(running, one.core)};
    failure.fsm_state = one.fsm_state;
    failure.core_after = one.core;
    failure.generation = failure.generation_after = running.generation;
    running.failures.note(one.name, std::move(failure));
  }
  running.failures.ask_log(running.log.history(), running.deployer.clock().now());
}

}  // namespace mauve::daemon
