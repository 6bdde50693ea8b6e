// SPDX-License-Identifier: LGPL-3.0-or-later
/// The reports of real-time threads, as log records.
#pragma once

#include "log/log.h"
#include "mauve/host/deployer.h"
#include "supervision/supervisor.h"

namespace mauve::daemon {

/// [log] The record of one happening.
[[nodiscard]] logging::Record record_of(const RuntimeEvent& happening);

/// [any] Empties the rings of all real-time threads into the log; requests also go to the
/// supervisor. Both outlive its use: take the source away before they go.
[[nodiscard]] logging::Log::Source runtime_events_of(Deployer& deployer, Supervisor& supervisor);

}  // namespace mauve::daemon
