// SPDX-License-Identifier: LGPL-3.0-or-later
/// CrashHandler: the last actions of a process that must die of a fault. The thread that failed
/// only wakes others and waits for them, since its handler may do next to nothing.
#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <optional>

#include "rt/thread/ends.h"
#include "rt/thread/run_guarded.h"
#include "rt/thread/thread.h"

namespace mauve::rt {

/// The thread that died, and the cause.
struct Death {
  Fault fault;
  std::array<char, 16> thread{};  ///< its name
};

/// A thread that sleeps until the process must die. While one lives, faults are handled (not under
/// a sanitizer, which handles them itself), and so is every end of the process that it can see.
class CrashHandler {
 public:
  CrashHandler() = default;
  ~CrashHandler();
  CrashHandler(const CrashHandler&) = delete;
  CrashHandler& operator=(const CrashHandler&) = delete;

  /// `speak` has 500 ms, and may be unable to allocate memory. Its thread has priority over all
  /// components, where that is permitted.
  Status start(std::function<void(const Death&)> speak);

 private:
  void wait();

  std::optional<FaultHandlers> faults_;
  std::optional<EndHandlers> ends_;
  std::function<void(const Death&)> speak_;
  std::atomic<bool> quit_{false};
  Thread thread_;
};

/// Wakes all crash handlers and waits until they have ended, 500 ms at most. A fault whose signal
/// is 0 is an exit(). Async-signal-safe. True when there was a handler, and all have ended.
bool run_crash_handler(const Fault& fault);

/// run_crash_handler() was called: the process ends. All that happens from here on is a consequence
/// of its end, and evidence against nobody. Async-signal-safe. [any]
[[nodiscard]] bool is_dying();

}  // namespace mauve::rt
