// SPDX-License-Identifier: LGPL-3.0-or-later
#include "notify.h"

#include <systemd/sd-daemon.h>

#include <cstdint>
#include <cstdlib>

namespace mauve::daemon::notify {

namespace {

/// A status of several lines would be read as several assignments.
std::string one_line(std::string text) {
  for (auto& c : text) {
    if (c == '\n') {
      c = ' ';
    }
  }
  return text;
}

void send(const std::string& state) { sd_notify(0, state.c_str()); }

}  // namespace

void ready(const std::string& status) { send("READY=1\nSTATUS=" + one_line(status)); }

void status(const std::string& status) { send("STATUS=" + one_line(status)); }

std::string how_to_see_all() {
  return std::getenv("NOTIFY_SOCKET") != nullptr ? "journalctl -u mauved shows all"
                                                 : "mauved --check shows all";
}

std::chrono::microseconds watchdog() {
  std::uint64_t time = 0;
  return std::chrono::microseconds(sd_watchdog_enabled(0, &time) > 0 ? time : 0);
}

void alive() { send("WATCHDOG=1"); }

void stopping(const std::string& status) { send("STOPPING=1\nSTATUS=" + one_line(status)); }

void extend(std::chrono::microseconds time) {
  send("EXTEND_TIMEOUT_USEC=" + std::to_string(time.count()));
}

}  // namespace mauve::daemon::notify
