// SPDX-License-Identifier: LGPL-3.0-or-later
#include "start_warnings.h"

#include <string>

#include "model/wiring.h"

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
                        const Architecture& architecture) {
  for (const auto& warning : deployer.warnings()) {
    log.write(event_of(warning), {{"text", warning}});
  }
  for (const auto& note : Wiring(architecture).notes()) {
    log.write(Event::connection_doubtful, {{"text", to_string(note)}, {"at", note.address}});
  }
}

}  // namespace mauve::daemon
