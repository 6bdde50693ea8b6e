// SPDX-License-Identifier: LGPL-3.0-or-later
/// Ctrl-C as a question of when to end, not as the end.
#pragma once

#include <signal.h>

namespace mauve::ctl {

/// The answer to a change is awaited: all that a signal handler can look at.
inline volatile sig_atomic_t g_change_awaited = 0;

/// While one lives, Ctrl-C sets came() and does not end the program. One at a time. [main]
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  [[nodiscard]] bool came() const;

 private:
  struct sigaction on_interrupt_ {};
  struct sigaction on_end_ {};
};

}  // namespace mauve::ctl
