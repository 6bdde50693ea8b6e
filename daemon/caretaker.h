// SPDX-License-Identifier: LGPL-3.0-or-later
/// Looks after what the running system does by itself: probations that end, rollbacks, cores that
/// took over from failing ones; keeps such cores in readiness.
#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "commands/command.h"

namespace mauve::daemon {

class Caretaker {
 public:
  Caretaker() = default;
  ~Caretaker() { stop(); }
  Caretaker(const Caretaker&) = delete;
  Caretaker& operator=(const Caretaker&) = delete;

  /// [main] From now on, 50 times a second.
  void start(Running& running);
  void stop();

 private:
  void run();
  void look();
  void tell(const Outcome& outcome);
  void save(const Outcome& outcome);
  void make_reliefs();

  Running* running_ = nullptr;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool stopping_ = false;
  std::atomic<bool> looking_{false};  ///< a look is queued or under way
  bool making_ = false;               ///< [control] reliefs are being made
  std::thread thread_;
};

}  // namespace mauve::daemon
