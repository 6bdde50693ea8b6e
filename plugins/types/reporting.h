// SPDX-License-Identifier: LGPL-3.0-or-later
/// Reports of a job to the log, and how often: a fault that comes back with every period is
/// reported at once, without filling the log.
#pragma once

#include <cstdint>

#include <mauve/log.h>

namespace rover {

/// True for the 1st, 10th, 100th, ... time. [any]
[[nodiscard]] constexpr bool worth_reporting(std::uint64_t count) {
  while (count >= 10 && count % 10 == 0) count /= 10;
  return count == 1;
}

/// A condition that is true or false, and reported when it changes. [rt]
class Condition {
 public:
  explicit Condition(bool at_first) : is_(at_first) {}

  /// True when it was otherwise at the last call.
  [[nodiscard]] bool changed(bool now) {
    const bool before = is_;
    is_ = now;
    return before != now;
  }

 private:
  bool is_;
};

}  // namespace rover
