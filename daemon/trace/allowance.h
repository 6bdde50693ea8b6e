// SPDX-License-Identifier: LGPL-3.0-or-later
/// How many flight recordings one kind of reason may have written: a recording has megabytes.
#pragma once

#include <chrono>
#include <cstddef>
#include <deque>

namespace mauve::daemon {

/// At most `count` in each span of `per`.
class FlightAllowance {
 public:
  using Time = std::chrono::steady_clock::time_point;

  FlightAllowance(std::size_t count, std::chrono::seconds per) : count_(count), per_(per) {}

  /// False: the allowance is used up.
  [[nodiscard]] bool take(Time now) {
    while (!granted_.empty() && now - granted_.front() >= per_) {
      granted_.pop_front();
    }
    if (granted_.size() == count_) {
      return false;
    }
    granted_.push_back(now);
    return true;
  }
  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] std::chrono::seconds per() const { return per_; }

 private:
  const std::size_t count_;
  const std::chrono::seconds per_;
  std::deque<Time> granted_;
};

}  // namespace mauve::daemon
