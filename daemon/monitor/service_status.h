// SPDX-License-Identifier: LGPL-3.0-or-later
/// The state of mauved as the service manager shows it: systemctl(1), `status`.
#pragma once

#include <string>

#include "monitor/heartbeat.h"
#include "signals.h"

namespace mauve::daemon {

/// "yard: 12 of 12 components run, ...", in one line. [control], or [main] before that runs
[[nodiscard]] std::string state_line(const Running& running);

/// Waits for a signal, and returns its name. Meanwhile it keeps the line of the service manager
/// true, and informs its watchdog while all is well; without a service manager it only waits.
/// `in_io`: runs a function on [io]. [main]
[[nodiscard]] std::string serve_until_signal(Running& running, Signals& signals,
                                             Heartbeat::Post in_io);

}  // namespace mauve::daemon
