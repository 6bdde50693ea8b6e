// SPDX-License-Identifier: LGPL-3.0-or-later
/// The signals that end the daemon, and the guarantee that it ends.
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <thread>

#include "base/mutex.h"

namespace mauve::daemon {

/// SIGTERM, SIGINT and SIGHUP (unless ignored, as under nohup). Blocked in every thread that is
/// started after this was made.
class Signals {
 public:
  /// [main] Before any other thread.
  Signals();

  /// [main] Waits for one: its name, or nothing when the time is over.
  [[nodiscard]] std::optional<std::string> wait(std::chrono::milliseconds time) const;
  [[nodiscard]] std::string wait() const;
};

/// Ends the process when a signal comes while it starts and the start does not end by itself soon:
/// a hook that hangs must not make it deaf.
class StartGuard {
 public:
  explicit StartGuard(const Signals& signals, std::function<void()> crash_handler);
  ~StartGuard() { static_cast<void>(finish()); }
  StartGuard(const StartGuard&) = delete;
  StartGuard& operator=(const StartGuard&) = delete;

  /// The start is over; the signal that came meanwhile, if any.
  [[nodiscard]] std::optional<std::string> finish();

  /// The time that the start still has after a signal.
  static constexpr std::chrono::milliseconds kPatience{3'000};

 private:
  void run();
  [[nodiscard]] bool finished_within(std::chrono::milliseconds time);

  const Signals& signals_;
  const std::function<void()> crash_handler_;
  std::optional<std::string> signal_;
  Mutex mutex_;
  ConditionVariable wake_;
  bool finished_ MAUVE_GUARDED_BY(mutex_) = false;
  std::thread thread_;
};

/// Ends the process when the orderly way takes too long, or when a second signal comes.
class Reaper {
 public:
  /// `crash_handler` is called before the process is ended with exit code 1; it must not block.
  Reaper(const Signals& signals, std::chrono::milliseconds patience,
         std::function<void(const std::string& cause)> crash_handler);
  /// The orderly way was quick enough.
  ~Reaper();
  Reaper(const Reaper&) = delete;
  Reaper& operator=(const Reaper&) = delete;

  /// The time that an orderly end still has after a second signal.
  static constexpr std::chrono::milliseconds kHurry{300};

 private:
  void run();
  [[nodiscard]] bool finished_within(std::chrono::milliseconds time);

  const Signals& signals_;
  const std::chrono::milliseconds patience_;
  const std::function<void(const std::string&)> crash_handler_;
  Mutex mutex_;
  ConditionVariable wake_;
  bool finished_ MAUVE_GUARDED_BY(mutex_) = false;
  std::thread thread_;
};

}  // namespace mauve::daemon
