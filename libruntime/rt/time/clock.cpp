// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/host/clock.h>

#include <time.h>

namespace mauve {

Instant MonotonicClock::now() const {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);
  return static_cast<Instant>(t.tv_sec) * 1'000'000'000 + t.tv_nsec;
}

}  // namespace mauve
