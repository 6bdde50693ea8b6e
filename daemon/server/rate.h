// SPDX-License-Identifier: LGPL-3.0-or-later
/// How often one user may change the system.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <map>

namespace mauve::server {

/// One token bucket a user, a second's worth deep. uid 0 always passes. [io]
class RateLimiter {
 public:
  using Clock = std::chrono::steady_clock;

  explicit RateLimiter(double per_second) : per_second_(per_second) {}

  /// Takes one token; false when there is none.
  [[nodiscard]] bool allow(uid_t uid, Clock::time_point now);

 private:
  struct Bucket {
    double tokens = 0;
    Clock::time_point filled;
  };

  double per_second_;
  std::map<uid_t, Bucket> buckets_;
};

}  // namespace mauve::server
