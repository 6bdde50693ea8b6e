// SPDX-License-Identifier: LGPL-3.0-or-later
/// ViewerShare: a viewer takes 5 % of a thread at most, however many requests it sends.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <map>
#include <optional>

namespace mauve::daemon {

/// After each request a viewer waits for 19 times the processor time that it took. Other users wait
/// for nothing: a FairQueue prefers them. Not locked.
class ViewerShare {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr int kWaitsTimes = 19;

  /// A request of this viewer took so much processor time, and ended now.
  void served(uid_t viewer, std::chrono::nanoseconds took, Clock::time_point now) {
    std::erase_if(waits_until_, [&](const auto& one) { return one.second <= now; });
    waits_until_[viewer] = now + kWaitsTimes * took;
  }
  [[nodiscard]] bool may(uid_t viewer, Clock::time_point now) const {
    const auto waits = waits_until_.find(viewer);
    return waits == waits_until_.end() || waits->second <= now;
  }
  /// When the next viewer may go on; nothing: none waits.
  [[nodiscard]] std::optional<Clock::time_point> next(Clock::time_point now) const {
    std::optional<Clock::time_point> earliest;
    for (const auto& [viewer, until] : waits_until_) {
      if (until > now && (!earliest || until < *earliest)) {
        earliest = until;
      }
    }
    return earliest;
  }

 private:
  std::map<uid_t, Clock::time_point> waits_until_;
};

}  // namespace mauve::daemon
