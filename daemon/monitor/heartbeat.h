// SPDX-License-Identifier: LGPL-3.0-or-later
/// The sign of life for the watchdog of the service manager: WatchdogSec= in the unit,
/// sd_watchdog_enabled(3).
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "base/mutex.h"
#include "commands/command.h"

namespace mauve::daemon {

/// Asks [control] and [io] whether they still serve, all threads with a pulse whether they turn,
/// and all components whether they make their releases.
class Heartbeat {
 public:
  using Post = std::function<void(std::function<void()>)>;

  /// `in_io`: runs a function on [io]; both outlive the heartbeat's use.
  Heartbeat(Running& running, Post in_io);

  /// Why the answers since the call before are no sign of life, for people; empty: all is well. The
  /// first call finds nothing wrong. Then asks again. Never waits. [main]
  [[nodiscard]] std::string look();

 private:
  /// Kept by questions that are still under way.
  struct Answers {
    std::atomic<bool> control{true};
    std::atomic<bool> io{true};
    Mutex mutex;
    std::string late MAUVE_GUARDED_BY(mutex);  // under mutex
  };
  void ask();

  Running& running_;
  const Post in_io_;
  std::chrono::steady_clock::time_point looked_ = std::chrono::steady_clock::now();
  const std::shared_ptr<Answers> answers_ = std::make_shared<Answers>();
};

/// The running components whose release is overdue by more than the bound of a job and a second.
/// The guard would have ended that job, so the guard does not work either. [control]
[[nodiscard]] std::string overdue(const Running& running);

}  // namespace mauve::daemon
