// SPDX-License-Identifier: LGPL-3.0-or-later
/// A log record as it is sent on the wire.
#pragma once

#include "commands/command.h"

namespace mauve::daemon {

/// [any] The members that the wire promises; `t0`: of the deployment.
[[nodiscard]] Json record_json(const logging::Record& record, Instant t0);

/// [any] [{"component","level","left_s"}] where it is not the usual one; an empty component: all.
[[nodiscard]] Json log_levels_json(const Running& running);

}  // namespace mauve::daemon
