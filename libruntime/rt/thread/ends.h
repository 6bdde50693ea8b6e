// SPDX-License-Identifier: LGPL-3.0-or-later
/// Ends of the process that no code handles: exit() wherever it is called, and signals whose
/// default is to end it. While an object lives, the crash handler runs first (crash_handler.h).
#pragma once

#include <csignal>

namespace mauve::rt {

/// A signal that the program handles or ignores itself stays as it is. SIGKILL, SIGSTOP and exec()
/// cannot be seen from inside. Not on real-time threads.
class EndHandlers {
 public:
  EndHandlers();
  ~EndHandlers();
  EndHandlers(const EndHandlers&) = delete;
  EndHandlers& operator=(const EndHandlers&) = delete;

  /// The calling thread is given none of these signals from now on. Returns its mask before.
  static sigset_t keep_away_from_this_thread();
  /// A call of exit(0) or _exit(0) while one of these lives ends the process with this status. So a
  /// service manager sees that the end was not asked for. 0, the default: the status stays 0. [any]
  static void set_unexpected_status(int status);
};

}  // namespace mauve::rt
