// SPDX-License-Identifier: LGPL-3.0-or-later
/// status.get, ping, version: the state of the system, and its version.
#include <algorithm>

#include "base/duration.h"
#include "commands/answer.h"
#include "commands/change/change.h"
#include "commands/command.h"
#include "commands/lock.h"
#include "commands/look/log_json.h"
#include "commands/look/parts_json.h"
#include "commands/model.h"
#include "commands/recovery/abandoned.h"
#include "commands/recovery/quarantine.h"
#include "commands/stops.h"
#include "mauve/host/architecture.h"
#include "mauve/host/resource.h"
#include "mauve/host/version.h"
#include "mauve/observable.h"
#include "monitor/guardian.h"
#include "state/state_store.h"
#include "supervision/rule_rows.h"
#include "supervision/supervisor.h"

namespace mauve::daemon {

namespace {

/// Names of the resources that refuse their users.
Json poisoned(const Running& running) {
  Json names = Json::array();
  for (auto* resource : running.architecture.resources()) {
    if (resource->lock().poisoned()) {
      names.push_back(resource->name());
    }
  }
  return names;
}

std::uint64_t jobs_left(const Running& running, const PlaceProbation& place) {
  const auto run = running.deployer.status(place.component).releases - place.releases;
  return place.rules.activations - std::min(run, place.rules.activations);
}

/// A swap in place, in the same form.
Json row_of(const Running& running, const PlaceProbation& place) {
  const Duration passed = std::chrono::steady_clock::now() - place.since;
  const bool confirms = place.rules.confirm_within > Duration{0};
  const auto left = (confirms ? place.rules.confirm_within : place.rules.time) - passed;
  return {{"generations", {place.generation}},
          {"components", {place.component}},
          {"state", place.rolls_back ? "rolls_back"
                    : confirms       ? "awaits_confirmation"
                                     : "watching"},
          {"left_ns", std::max(left, Duration{0}).count()},
          {"jobs", confirms ? Json() : Json(place.rules.activations)},
          {"jobs_left", confirms ? Json() : Json(jobs_left(running, place))}};
}

/// The changes that are on probation or wait for a confirmation, the oldest first.
Json probations(const Running& running) {
  Json rows = Json::array();
  for (const auto& one : running.deployer.probations()) {
    const auto& rules = one.rules;
    const bool confirms = rules.confirm_within > Duration{0};
    const auto left = (confirms ? rules.confirm_within : rules.time) - one.passed;
    rows.push_back({{"generations", one.generations},
                    {"components", one.components},
                    {"state", one.rolls_back    ? "rolls_back"
                              : confirms        ? "awaits_confirmation"
                              : rules.only_undo ? "awaits_undo"
                                                : "watching"},
                    {"left_ns", std::max(left, Duration{0}).count()},
                    {"jobs", confirms ? Json() : Json(rules.activations)},
                    {"jobs_left", confirms ? Json() : Json(one.jobs_left)}});
  }
  for (const auto& place : running.places) {
    rows.push_back(row_of(running, place));
  }
  return rows;
}

/// The user who set the lock; null: nothing is locked.
Json lock_request(const Running& running) {
  if (running.lock == Lock::none) {
    return nullptr;
  }
  const auto& [uid, time, reason] = running.locked;
  return {{"uid", uid}, {"time", time}, {"reason", reason}};
}

/// Warnings that last, such as "imu.core.silent lasts for 12s: its device sends nothing".
void add_warnings(Json& notes, const Running& running, const CoreBase& core) {
  for (const auto* observable : core.observables()) {
    const auto* const warning = dynamic_cast<const Warning*>(observable);
    if (warning == nullptr || !warning->lasts()) {
      continue;
    }
    const Duration lasted{running.deployer.clock().now() - warning->written()};
    const auto reason = std::string(warning->reason());
    notes.push_back(
        {{"address", warning->address()},
         {"text", "lasts for " + format_duration(std::chrono::floor<std::chrono::seconds>(lasted)) +
                      (reason.empty() ? "" : ": " + reason)}});
  }
}

/// Last, of the plugins that still run in the build of the start, which is another one than that of
/// the saved generation.
Json notes_of(const Running& running) {
  Json notes = wiring_notes(running);
  for (const auto* component : running.architecture.components()) {
    add_warnings(notes, running, *component->bundle()->core);
  }
  for (const auto* resource : running.architecture.resources()) {
    add_warnings(notes, running, resource->core());
  }
  if (const auto missing = running.log.unwritten(); missing > 0) {
    notes.push_back({{"address", "log"},
                     {"text", std::to_string(missing) +
                                  " times a destination of the log did not take a record since the "
                                  "start: mauvectl logs --grep 'the log'"}});
  }
  for (const auto& one : running.other_builds) {
    const auto* loaded = running.catalog.find(one.plugin);
    if (loaded != nullptr && loaded->info().build_id == one.runs) {
      notes.push_back({{"address", one.plugin},
                       {"text", "runs build " + short_build(one.runs) + ", generation " +
                                    std::to_string(running.recovered) + " ran build " +
                                    short_build(one.recorded) + ": " + remedy_of(one)}});
    }
  }
  return notes;
}

/// Of the plugin that brought it; null for a core of the program itself.
Json version_of(const Running& running, const std::string& core) {
  const auto* loaded = running.catalog.find(plugin_of(core));
  return loaded == nullptr ? Json() : Json(loaded->info().version);
}

Json row_of(const Running& running, const ComponentStatus& one) {
  Json row = {{"name", one.name},
              {"type", one.type},
              {"core", one.core},
              {"core_version", version_of(running, one.core)},
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
              {"implausible", one.implausible_of_core},
              {"late_ns", one.late.count()},
              {"period_ns", one.period.count()},
              {"next_release_ns", one.next_release.count()},
              {"lateness_last_ns", one.lateness_last.count()},
              {"lateness_max_ns", one.lateness_max.count()},
              {"elapsed_last_ns", one.elapsed_last.count()},
              {"elapsed_max_ns", one.elapsed_max.count()}};
  if (!one.fault.empty()) {
    row["fault"] = one.fault;
  }
  if (const auto* stop = stop_of(running, one.name)) {
    row["stopped_by"] = in_words(*stop);
  }
  if (one.state == ComponentState::recovering) {
    row["recovery"] = recovery_json(one.recovery);
  }
  if (one.state == ComponentState::faulted) {
    row["hint"] = step_to_run(running, one);
  }
  return row;
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
    rows.push_back(row_of(running, one));
  }
  const std::chrono::duration<double> up = std::chrono::steady_clock::now() - running.since;
  Json result = {
      {"generation", running.deployer.generation()},
      {"architecture", running.architecture.name()},
      {"uptime_s", up.count()},
      {"t_ns", running.deployer.clock().now() - running.deployer.t0()},
      {"realtime", running.deployer.realtime()},
      {"lock", to_string(running.lock)},
      {"locked", lock_request(running)},
      {"log_levels", log_levels_json(running)},
      {"components", std::move(rows)},
      {"poisoned", poisoned(running)},
      {"abandoned_threads", abandoned_threads(running)},
      {"probations", probations(running)},
      {"notes", notes_of(running)},
      {"unknown_values", lost_values(running.supervisor.engine())},
      {"blocked_rules", blocked_rules(running.supervisor.engine(), running.deployer.clock().now(),
                                      running.supervisor.reader())},
      {"recovered", running.recovered == 0 ? Json() : Json(running.recovered)},
      {"quarantine", running.quarantined.size()}};
  if (running.guardian != nullptr) {
    result["guardian"] = running.guardian->json();
  }
  if (running.store != nullptr) {
    result["saved"] = running.store->saved();
    const std::chrono::duration<double> silent =
        running.disk_watch.silent_for(std::chrono::steady_clock::now());
    if (silent.count() > 0) {
      result["disk_silent_s"] = silent.count();
    }
  }
  return result;
}

}  // namespace mauve::daemon
