// SPDX-License-Identifier: LGPL-3.0-or-later
/// A thread that sleeps until another one calls it.
#pragma once

#include <poll.h>
#include <pthread.h>

#include <atomic>
#include <functional>

#include <mauve/result.h>

#include <mauve/serial/serial_port.h>

namespace mauve::serial {

/// A thread of mauved with 256 KiB of stack, which no signal reaches. It has ordinary priority,
/// whichever thread makes it, until hurry().
class CalledThread {
 public:
  CalledThread() = default;
  CalledThread(const CalledThread&) = delete;
  CalledThread& operator=(const CalledThread&) = delete;
  ~CalledThread() { join(); }

  /// Runs it, under a name of 15 bytes at most. Refused when the system has no room for it.
  /// [factory]
  mauve::Status begin(const char* name, std::function<void()> run);
  /// Until it has ended. [factory]
  void join();
  /// Ends its wait(), or the next one. Bounded. [rt]
  void call() const;
  /// SCHED_FIFO 2 from the end of its wait() on: before ordinary work and the threads of mauved
  /// that serve requests, and after every component of a higher priority. [rt]
  void hurry();
  /// Whether the calling thread has a real-time priority, so that what it calls should hurry. [rt]
  [[nodiscard]] static bool caller_is_real_time();

  /// The thread itself: sleeps until call(), for `longest` ms at most unless that is -1, or until
  /// something happens to `other`. True: it was called.
  bool wait(int longest, pollfd* other = nullptr);

 private:
  void raise_priority();

  std::function<void()> run_;
  const char* name_ = "";
  Descriptor bell_;
  pthread_t thread_{};
  bool runs_ = false;
  std::atomic<bool> hurried_{false};
};

}  // namespace mauve::serial
