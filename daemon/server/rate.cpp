// SPDX-License-Identifier: LGPL-3.0-or-later
#include "server/rate.h"

#include <algorithm>

namespace mauve::server {

bool RateLimiter::allow(uid_t uid, Clock::time_point now) {
  if (uid == 0) {
    return true;
  }
  const auto [it, is_new] = buckets_.try_emplace(uid, Bucket{per_second_, now});
  auto& bucket = it->second;
  const std::chrono::duration<double> passed = now - bucket.filled;
  bucket.tokens = std::min(per_second_, bucket.tokens + passed.count() * per_second_);
  bucket.filled = now;
  if (bucket.tokens < 1) {
    return false;
  }
  bucket.tokens -= 1;
  return true;
}

}  // namespace mauve::server
