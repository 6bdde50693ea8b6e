// SPDX-License-Identifier: LGPL-3.0-or-later
#include "commands/look/notice.h"

#include "base/thread_role.h"

#include <chrono>
#include <set>
#include <utility>

#include "commands/recovery/quarantine.h"
#include "mauve/host/architecture.h"

namespace mauve::daemon {

namespace {

Reaction reaction_of(Outcome::Kind kind) {
  if (kind == Outcome::Kind::rolled_back) {
    return Reaction::rolled_back;
  }
  if (kind == Outcome::Kind::stays_failed) {
    return Reaction::parked;
  }
  return kind == Outcome::Kind::fell_back ? Reaction::fell_back : Reaction::restarted;
}

/// As the thread of the component recorded it.
Failure failure_of(const Running& running, const std::string& component, const Incident& incident) {
  using std::chrono::system_clock;
  const std::chrono::nanoseconds ago{running.deployer.clock().now() - incident.time};
  Failure failure;
  failure.time =
      logging::utc(system_clock::now() - std::chrono::duration_cast<system_clock::duration>(ago));
  failure.monotonic_ns = incident.time;
  failure.cause = incident.cause;
  failure.text = incident.text;
  failure.fsm_state = incident.state;
  failure.job = incident.job;
  failure.resource = incident.resource;
  // The build that ran is known by now only if no other one has replaced it.
  failure.culprit = running.failures.running(component);
  if (failure.culprit.core != incident.core) {
    failure.culprit = {incident.core, build_of(running, incident.core)};
  }
  return failure;
}

}  // namespace

void remember_cores(Running& running) {
  MAUVE_ON_THREAD(control);
  std::set<std::string> names;
  for (const auto* component : running.architecture.components()) {
    names.insert(component->name());
    const auto& core = component->bundle()->core_type.name;
    running.failures.runs(component->name(), {core, build_of(running, core)});
  }
  running.failures.keep_only(names);
}

void notice(Running& running, const Outcome& outcome) {
  MAUVE_ON_THREAD(control);
  if (!outcome.component.empty() && outcome.incident) {
    auto failure = failure_of(running, outcome.component, *outcome.incident);
    failure.reaction = reaction_of(outcome.kind);
    failure.generation = outcome.began;
    failure.generation_after = outcome.generation;
    if (const auto* component = running.architecture.find_component(outcome.component)) {
      failure.core_after = component->bundle()->core_type.name;
      failure.state_after = to_string(running.deployer.status(outcome.component).state);
    }
    running.failures.note(outcome.component, std::move(failure));
  }
  remember_cores(running);
}

void notice_failed(Running& running) {
  MAUVE_ON_THREAD(control);
  for (const auto& one : running.deployer.status()) {
    const auto reaction =
        one.state == ComponentState::recovering ? Reaction::recovers : Reaction::parked;
    if (!one.incident || is_place(running, one.name) ||
        running.failures.knows(one.name, one.incident->time, reaction)) {
      continue;
    }
    auto failure = failure_of(running, one.name, *one.incident);
    failure.reaction = reaction;
    failure.core_after = one.core;
    failure.generation = failure.generation_after = running.generation;
    running.failures.note(one.name, std::move(failure));
  }
  running.failures.ask_log(running.log.history(), running.deployer.clock().now());
}

}  // namespace mauve::daemon
