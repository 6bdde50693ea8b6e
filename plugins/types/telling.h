// SPDX-License-Identifier: LGPL-3.0-or-later
/// What a job tells the log, and how often: a fault that comes back with every period shall be told
/// at once, and not fill the log.
#pragma once

#include <cstdint>

#include <mauve/log.h>

namespace rover {

/// For the 1st, 10th, 100th, ... time. [any]
[[nodiscard]] constexpr bool worth_reporting(std::uint64_t count) {
  while (count >= 10 && count % 10 == 0) count /= 10;
  return count == 1;
}

/// Something that is so, or not so: told when it changes. [rt]
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
