// SPDX-License-Identifier: LGPL-3.0-or-later
/// A Create 2 on a pseudo-terminal, as far as a test needs one: it reports once it is begun, and
/// its wheels stand. A driver orders no base to drive that does not report; a test about one that
/// never does has an Outlet in its place.
#pragma once

#include <gtest/gtest.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <mauve/host/clock.h>

#include "rt/thread/thread.h"
#include "support/outlet.h"
#include "support/write_times.h"

namespace mauve::test {

/// The order to drive, and the whole of the order to stand.
inline constexpr char kDrive = '\x91';
inline const std::string kStand("\x91\0\0\0\0", 5);
/// The order to stream; no speed of these tests has such a byte.
inline constexpr char kStream = '\x94';

/// Its thread notes when each order was written or came, and reports: every 15 ms, whatever is
/// asked for, the bumper, the mode, and the two counts. All of it is [any].
class FakeBase {
 public:
  /// Priority 0: an ordinary thread; else it notes when each order was written.
  explicit FakeBase(int priority = 0) {
    if (priority > 0) times_.emplace(line_.path(), priority);
    EXPECT_TRUE(thread_.start({"base", priority, {}, 64 * 1024}, [this] { run(); }));
  }
  ~FakeBase() {
    ends_ = true;
    thread_.join();
  }
  FakeBase(const FakeBase&) = delete;
  FakeBase& operator=(const FakeBase&) = delete;

  [[nodiscard]] const std::string& path() const { return line_.path(); }
  /// All that came so far.
  [[nodiscard]] std::string bytes() {
    const std::scoped_lock lock(mutex_);
    return line_.bytes();
  }
  /// Orders with a speed that came so far.
  [[nodiscard]] std::uint64_t drives() const { return drives_; }
  /// When it got the order to stand, and none to drive since; 0: it drives, or got no order.
  [[nodiscard]] Instant stands_since() const { return stands_since_; }

  /// From now on orders may be held up on their way.
  void measure() { times_->measure(); }

  /// The mode that it reports: 2 (safe) at first.
  void report(int mode) { mode_ = mode; }
  /// It reports nothing, whatever is asked for.
  void fall_silent(bool silent) { silent_ = silent; }

 private:
  static constexpr Instant kPeriod = 15'000'000;  // ns

  void run() {
    Instant next = 0;
    while (!ends_) {
      pollfd come{line_.descriptor(), POLLIN, 0};
      if (poll(&come, 1, 5) == 0 && times_) times_->rest();
      listen();
      const Instant now = MonotonicClock().now();
      if (!begun_ || silent_ || now < next) continue;
      next = now + kPeriod;
      send_report();
    }
  }

  void listen() {
    const std::scoped_lock lock(mutex_);
    const std::string& all = line_.bytes();
    const Instant now = MonotonicClock().now();
    std::vector<std::size_t> orders;  // to stream or to drive
    for (; seen_ < all.size(); ++seen_) {
      if (all[seen_] != kDrive && all[seen_] != kStream) continue;
      if (all[seen_] == kDrive && all.size() - seen_ < kStand.size()) break;
      orders.push_back(seen_);
      if (all[seen_] == kDrive) seen_ += kStand.size() - 1;
    }
    if (times_) times_->came(orders.size());
    for (const std::size_t at : orders) {
      const Instant written = times_ ? times_->next(now) : now;
      if (all[at] == kStream) begun_ = true;
      if (all[at] == kDrive) obey(all.compare(at, kStand.size(), kStand) == 0, written);
    }
  }

  void obey(bool stand, Instant now) {
    if (!stand) ++drives_;
    if (!stand) stands_since_ = 0;
    if (stand && stands_since_ == 0) stands_since_ = now;
  }

  /// A line that nobody reads is full some time: the rest is lost then.
  void send_report() const {
    std::array<char, 13> frame{19, 10, 7, 0, 35, 0, 43, 0, 0, 44, 0, 0, 0};
    frame[5] = static_cast<char>(mode_.load());
    unsigned sum = 0;
    for (const char byte : frame) sum += static_cast<unsigned char>(byte);
    frame.back() = static_cast<char>(256U - sum % 256U);
    static_cast<void>(!write(line_.descriptor(), frame.data(), frame.size()));
  }

  Outlet line_;
  std::optional<WriteTimes> times_;
  std::mutex mutex_;      // guards the bytes of the line
  std::size_t seen_ = 0;  // of its thread, as is begun_
  bool begun_ = false;
  std::atomic<std::uint64_t> drives_{0};
  std::atomic<Instant> stands_since_{0};
  std::atomic<int> mode_{2};
  std::atomic<bool> silent_{false};
  std::atomic<bool> ends_{false};
  rt::Thread thread_;
};

}  // namespace mauve::test
