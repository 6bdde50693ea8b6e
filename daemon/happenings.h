// SPDX-License-Identifier: LGPL-3.0-or-later
/// What real-time threads report, as log records.
#pragma once

#include "log/log.h"
#include "mauve/deployer.h"

namespace mauve::daemon {

/// [log] The record of one happening.
[[nodiscard]] logging::Record record_of(const Happening& happening);

/// [any] Empties the rings of all real-time threads into the log. The deployer outlives its use:
/// take the source away before it goes.
[[nodiscard]] logging::Log::Source happenings_of(Deployer& deployer);

}  // namespace mauve::daemon
