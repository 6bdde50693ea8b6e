// SPDX-License-Identifier: LGPL-3.0-or-later
/// The warnings of a start about an architecture that it puts in force nevertheless.
#pragma once

#include "log/log.h"
#include "mauve/host/deployer.h"
#include "rules/supervision.h"

namespace mauve::daemon {

/// [main] Logs each warning of the deployer, each connection that may be a mistake, and each
/// transaction that these connections keep from taking effect.
void log_start_warnings(logging::Log& log, const Deployer& deployer,
                        const Architecture& architecture, const rules::Supervision& supervision);

}  // namespace mauve::daemon
