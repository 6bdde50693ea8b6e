// SPDX-License-Identifier: LGPL-3.0-or-later
/// The signals that end the daemon, and the guarantee that it ends.
#pragma once

#include <signal.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <thread>

#include "base/mutex.h"

namespace mauve::daemon {

/// The signals that end mauved in order: SIGTERM always; SIGINT and SIGHUP unless they were ignored
/// at the start, as under nohup and for a program that a script starts with "&". SIGHUP does so
/// only where it reports the end of a terminal: elsewhere it says that a log was rotated. Blocked
/// in every thread that is started after this was made.
class Signals {
 public:
  /// [main] Before any other thread. With a file of the log SIGHUP ends nothing: the file was
  /// rotated, and the log follows its name by itself.
  explicit Signals(bool has_log_file);

  /// [main] Waits for one: its name, or nothing when the time is over.
  [[nodiscard]] std::optional<std::string> wait(std::chrono::milliseconds time) const;
  [[nodiscard]] std::string wait() const;

 private:
  sigset_t ends_{};
};

/// Ends the process where it does not end by itself. That is so when a signal comes while it starts
/// and a hook hangs, when the orderly end takes too long, and when a second signal comes. One
/// thread does both, and is there before any component runs: an end needs no thread more.
class Reaper {
 public:
  /// [main] The start begins. `crash_handler` is called before the process is ended with exit code
  /// 1; it must not block.
  Reaper(const Signals& signals, std::function<void(const std::string& cause)> crash_handler);
  ~Reaper();
  Reaper(const Reaper&) = delete;
  Reaper& operator=(const Reaper&) = delete;

  /// [main] The start is over; the signal that came meanwhile, if any. [main] waits for signals
  /// itself from now on.
  [[nodiscard]] std::optional<std::string> start_is_over();
  /// [main] The end begins, and may take so long.
  void end_begins(std::chrono::milliseconds patience);
  /// [main] The end was quick enough.
  void end_is_over() { enter(Phase::over); }

  /// The time that the start still has after a signal.
  static constexpr std::chrono::milliseconds kPatience{3'000};
  /// The time that an orderly end still has after a second signal.
  static constexpr std::chrono::milliseconds kHurry{300};

 private:
  enum class Phase : std::uint8_t { starting, running, ending, over };

  void run();
  void watch_start();
  void watch_end();
  void enter(Phase phase);
  /// The phase is another one within this time.
  [[nodiscard]] bool leaves(Phase phase, std::chrono::milliseconds time);
  [[noreturn]] void reap(const std::string& cause);

  const Signals& signals_;
  const std::function<void(const std::string&)> crash_handler_;
  std::optional<std::string> signal_;  ///< [reaper], then [main]
  std::chrono::milliseconds patience_{0};
  Mutex mutex_;
  ConditionVariable wake_;
  Phase phase_ MAUVE_GUARDED_BY(mutex_) = Phase::starting;
  bool watched_ MAUVE_GUARDED_BY(mutex_) = true;  ///< the start
  std::thread thread_;
};

}  // namespace mauve::daemon
