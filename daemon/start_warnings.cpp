// SPDX-License-Identifier: LGPL-3.0-or-later
#include "start_warnings.h"

#include <algorithm>
#include <iterator>
#include <string>

#include "arch/build/check_rules.h"
#include "mauve/host/architecture.h"
#include "model/component/wiring.h"

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
                        const Architecture& architecture, const rules::Supervision& supervision) {
  for (const auto& warning : deployer.warnings()) {
    log.write(event_of(warning), {{"text", warning}});
  }
  auto notes = Wiring(architecture).notes();
  std::ranges::copy(arch::notes_on(supervision, architecture), std::back_inserter(notes));
  for (const auto& note : notes) {
    log.write(Event::connection_doubtful, {{"text", to_string(note)}, {"at", note.address}});
  }
}

}  // namespace mauve::daemon
