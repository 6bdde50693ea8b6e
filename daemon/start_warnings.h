// SPDX-License-Identifier: LGPL-3.0-or-later
/// Warnings for the log, of a start or of a plugin that is loaded, which go on nevertheless.
#pragma once

#include <cstdint>
#include <set>
#include <string>

#include "log/log.h"
#include "mauve/host/deployer.h"
#include "plugin/load/library.h"
#include "rules/supervision.h"
#include "state/builds.h"

namespace mauve::daemon {

/// [main] Logs each warning of the deployer, each connection that may be a mistake, and each
/// transaction that is refused while the system is as the architecture has it.
void log_start_warnings(logging::Log& log, const Deployer& deployer,
                        const Architecture& architecture, const plugin::Catalog& catalog,
                        const rules::Supervision& supervision);

/// [control], or [main] before that runs. Logs that a plugin is loaded, and each warning about it.
void log_loaded(logging::Log& log, const plugin::PluginInfo& info);

/// [main] Logs each plugin that runs in another build than the one that this saved generation ran
/// with.
void log_other_builds(logging::Log& log, std::uint64_t generation, const OtherBuilds& others);

/// [main] Logs each component that starts with one of these cores, which are in quarantine.
void log_cores_in_quarantine(logging::Log& log, const Architecture& architecture,
                             const std::set<std::string, std::less<>>& cores);

}  // namespace mauve::daemon
