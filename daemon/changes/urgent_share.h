// SPDX-License-Identifier: LGPL-3.0-or-later
/// UrgentShare: a thread that precedes ordinary ones takes a tenth of a processor at most so.
#pragma once

#include <algorithm>
#include <functional>
#include <memory>

#include "mauve/host/clock.h"
#include "mauve/time.h"
#include "rt/thread/thread.h"
#include "rt/time/cpu_time.h"

namespace mauve::daemon {

/// A token bucket of 10 ms of processor time, which fills at a tenth of real time. The thread is
/// urgent until its bucket is empty, and again when it is half full.
class UrgentShare {
 public:
  static constexpr Duration kBurst{10'000'000};
  static constexpr int kOneOf = 10;

  /// Whether it is urgent from now on. `used`: processor time so far.
  [[nodiscard]] bool look(Instant now, Duration used) {
    if (now_ != 0) left_ += Duration{now - now_} / kOneOf - (used - used_);
    left_ = std::min(left_, kBurst);
    now_ = now;
    used_ = used;
    return urgent_ = left_ > (urgent_ ? Duration{0} : kBurst / 2);
  }

 private:
  Duration left_ = kBurst;
  Instant now_ = 0;
  Duration used_{0};
  bool urgent_ = true;
};

/// A thread calls it after each piece of its work, to have SCHED_FIFO of this priority within its
/// share, where that is permitted. Empty for 0: the thread is an ordinary one.
[[nodiscard]] inline std::function<void()> urgent_within_share(int priority) {
  if (priority == 0) return {};
  return [priority, share = UrgentShare(), urgent = std::shared_ptr<rt::Boost>()]() mutable {
    if (!share.look(MonotonicClock().now(), rt::cpu_time())) {
      urgent = nullptr;
    } else if (urgent == nullptr) {
      urgent = std::make_shared<rt::Boost>(priority);
    }
  };
}

}  // namespace mauve::daemon
