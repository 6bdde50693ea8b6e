// SPDX-License-Identifier: LGPL-3.0-or-later
#include "server/refusals.h"

#include "base/mutex.h"

namespace mauve::server {

bool Refusals::may_write(std::uint32_t uid, Time now) {
  const MutexLock lock(mutex_);
  auto [found, first] = users_.try_emplace(uid, Second{now});
  auto& second = found->second;
  const bool over = now - second.begin >= std::chrono::seconds(1);
  if (over && second.counted == 0) {  // the count is reported first
    second = Second{now};
  }
  if (second.written < kPerSecond) {
    ++second.written;
    return true;
  }
  ++second.counted;
  return false;
}

bool Refusals::empty() {
  const MutexLock lock(mutex_);
  return users_.empty();
}

std::vector<Refusals::Counted> Refusals::take_counted(Time now) {
  const MutexLock lock(mutex_);
  std::vector<Counted> reported;
  std::erase_if(users_, [&](const auto& entry) {
    const auto& [uid, second] = entry;
    const bool over = now - second.begin >= std::chrono::seconds(1);
    if (over && second.counted > 0) {
      reported.push_back({uid, second.counted});
    }
    return over;
  });
  return reported;
}

}  // namespace mauve::server
