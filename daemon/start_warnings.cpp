// SPDX-License-Identifier: LGPL-3.0-or-later
#include "start_warnings.h"

#include <string>

#include "arch/build/check_rules.h"
#include "mauve/host/architecture.h"

namespace mauve::daemon {

namespace {

using logging::Event;

Event event_of(const std::string& warning) {
  if (warning.starts_with("timing")) {
    return Event::realtime_missing;
  }
  if (warning.starts_with("throttling")) {
    return Event::throttling_first;
  }
  return warning.starts_with("admission") ? Event::not_admitted : Event::task_placed;
}

}  // namespace

void log_start_warnings(logging::Log& log, const Deployer& deployer,
                        const Architecture& architecture, const plugin::Catalog& catalog,
                        const rules::Supervision& supervision) {
  for (const auto& warning : deployer.warnings()) {
    log.write(event_of(warning), {{"text", warning}});
  }
  for (const auto& note : arch::notes_on_file(supervision, architecture, catalog)) {
    log.write(Event::connection_doubtful, {{"text", to_string(note)}, {"at", note.address}});
  }
}

void log_loaded(logging::Log& log, const plugin::PluginInfo& info) {
  log.write(Event::plugin_loaded, {{"plugin", info.name},
                                   {"version", info.version},
                                   {"file", info.file},
                                   {"build_id", info.build_id}});
  for (const auto& warning : info.warnings) {
    log.write(Event::plugin_doubtful, {{"plugin", info.name}, {"text", warning}});
  }
}

void log_other_builds(logging::Log& log, std::uint64_t generation, const OtherBuilds& others) {
  for (const auto& one : others) {
    log.write(Event::plugin_other_build, {{"generation", static_cast<std::int64_t>(generation)},
                                          {"plugin", one.plugin},
                                          {"recorded", short_build(one.recorded)},
                                          {"runs", short_build(one.runs)},
                                          {"text", remedy_of(one)}});
  }
}

void log_cores_in_quarantine(logging::Log& log, const Architecture& architecture,
                             const std::set<std::string, std::less<>>& cores) {
  for (const auto* component : architecture.components()) {
    const auto& core = component->bundle()->core_type.name;
    if (cores.contains(core)) {
      log.write(Event::quarantine_started, {{"component", component->name()}, {"core", core}});
    }
  }
}

}  // namespace mauve::daemon
