// SPDX-License-Identifier: LGPL-3.0-or-later
/// Notifications to the service manager (sd_notify). Does nothing when there is none.
#pragma once

#include <chrono>
#include <string>

namespace mauve::daemon::notify {

/// All threads run with the asked policy and the socket is open. `status` is one line of truth.
void ready(const std::string& status);
void status(const std::string& status);
/// The time in which the service manager wants to hear alive() again; zero: it does not ask.
[[nodiscard]] std::chrono::microseconds watchdog();
void alive();
/// The command that shows all reasons of a refused start. A check by hand lacks the options that
/// the unit gives.
[[nodiscard]] std::string how_to_see_all();
/// The orderly end has begun.
void stopping(const std::string& status);
/// Start or stop take longer than the unit allows: this much more, from now.
void extend(std::chrono::microseconds time);

}  // namespace mauve::daemon::notify
