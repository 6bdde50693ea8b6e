// SPDX-License-Identifier: LGPL-3.0-or-later
/// How many refusals of one user (changes, connections) are written down one by one. A client that
/// is refused thousands of times a second must fill neither the log nor the disk.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "base/mutex.h"

namespace mauve::server {

class Refusals {
 public:
  using Time = std::chrono::steady_clock::time_point;

  static constexpr unsigned kPerSecond = 20;  ///< of one user

  /// Refusals that were not written down one by one.
  struct Counted {
    std::uint32_t uid;
    std::uint64_t count;
  };

  /// [any but rt] False: counted only.
  [[nodiscard]] bool may_write(std::uint32_t uid, Time now);
  /// [any but rt] The counts of seconds that are over; they are forgotten then.
  [[nodiscard]] std::vector<Counted> take_counted(Time now);
  /// [any but rt] Nothing was refused since take_counted() forgot the last user.
  [[nodiscard]] bool empty();

 private:
  struct Second {
    Time begin;
    unsigned written = 0;
    std::uint64_t counted = 0;
  };

  Mutex mutex_;
  std::map<std::uint32_t, Second> users_ MAUVE_GUARDED_BY(mutex_);  ///< of the last second
};

}  // namespace mauve::server
