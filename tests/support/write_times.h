// SPDX-License-Identifier: LGPL-3.0-or-later
/// When a terminal was written to. An ordinary thread of the kernel hands the bytes of a
/// pseudo-terminal over. Any urgent thread on its CPU holds that one up, and with it everybody who
/// looks for bytes. The device of a robot has the bytes when the call has returned.
#pragma once

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <deque>
#include <mutex>
#include <string>

#include "rt/thread/thread.h"

#include <mauve/host/clock.h>

namespace mauve::test {

/// Gives each frame that comes the time of the call that wrote it, or a later one. A call writes
/// one frame or more, and a frame may come before its notice. Frames that were noticed may be
/// dropped before they come (SafeOrder::drop_unsent).
class WriteTimes {
 public:
  WriteTimes(const std::string& path, int priority)
      : notices_(inotify_init1(IN_NONBLOCK | IN_CLOEXEC)) {
    inotify_add_watch(notices_, path.c_str(), IN_MODIFY);
    EXPECT_TRUE(thread_.start({"writes", priority, {}, 64 * 1024}, [this] { run(); }));
  }
  ~WriteTimes() {
    quit_ = true;
    thread_.join();
    close(notices_);
  }
  WriteTimes(const WriteTimes&) = delete;
  WriteTimes& operator=(const WriteTimes&) = delete;

  /// So many frames came at once.
  void came(std::size_t frames) {
    const std::lock_guard hold(lock_);
    while (written_.size() > frames) written_.pop_front();
    last_ = 0;
  }
  /// Of the next one of them; `now` where no notice of it is here. Of several frames without
  /// notices of their own, the call that wrote the one before wrote them too.
  [[nodiscard]] Instant next(Instant now) {
    const std::lock_guard hold(lock_);
    if (!written_.empty()) {
      last_ = written_.front();
      written_.pop_front();
    } else if (last_ == 0) {
      ++early_;
      early_at_ = now;
      return now;
    }
    return last_;
  }
  /// No frame came for a while, and none is held up: all that was noticed has come.
  void rest() {
    const std::lock_guard hold(lock_);
    if (measures_) return;
    written_.clear();
    early_ = 0;
  }
  /// From now on frames may be held up.
  void measure() { measures_ = true; }

 private:
  /// A frame comes so much before its notice at most.
  static constexpr Instant kNotLater = 5'000'000;  // ns

  void run() {
    std::array<char, 4096> some{};
    while (!quit_) {
      pollfd come{notices_, POLLIN, 0};
      if (poll(&come, 1, 5) <= 0 || read(notices_, some.data(), some.size()) <= 0) continue;
      const Instant now = MonotonicClock().now();
      const std::lock_guard hold(lock_);
      if (now - early_at_ > kNotLater) early_ = 0;  // the kernel has joined two notices
      if (early_ == 0) written_.push_back(now);
      if (early_ > 0) --early_;  // its frame came before it
    }
  }

  int notices_;
  std::mutex lock_;
  std::deque<Instant> written_;
  Instant last_ = 0;  // of the frame before, of those that came at once
  std::size_t early_ = 0;
  Instant early_at_ = 0;
  std::atomic<bool> measures_{false};
  std::atomic<bool> quit_{false};
  rt::Thread thread_;
};

}  // namespace mauve::test
