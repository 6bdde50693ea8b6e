// SPDX-License-Identifier: LGPL-3.0-or-later
/// Reports of a job to the log, and how often: a fault that comes back with every period is
/// reported at once, without filling the log.
#pragma once

#include <cstddef>
#include <cstdint>

#include <mauve/log.h>

namespace rover {

/// True for the 1st, 10th, 100th, ... time. [any]
[[nodiscard]] constexpr bool worth_reporting(std::uint64_t count) {
  while (count >= 10 && count % 10 == 0) count /= 10;
  return count == 1;
}

/// A condition that is good or bad, and reported when it changes. [rt]
class Condition {
 public:
  explicit Condition(bool good_at_first) : good_(good_at_first) {}

  /// True when it was otherwise at the last call.
  [[nodiscard]] bool changed(bool good) {
    const bool before = good_;
    good_ = good;
    return before != good;
  }

  [[nodiscard]] bool is_good() const { return good_; }

  /// Logs `good_text` as information, or `bad_text` as a warning, when it changed. Either text may
  /// show `argument`.
  template <std::size_t N, std::size_t M>
  void report(bool good, const char (&good_text)[N], const char (&bad_text)[M],
              mauve::LogArgument argument = {}) {
    if (!changed(good)) return;
    if (good) {
      mauve::log(mauve::LogLevel::info, good_text, argument);
    } else {
      mauve::log(mauve::LogLevel::warning, bad_text, argument);
    }
  }

 private:
  bool good_;
};

}  // namespace rover
