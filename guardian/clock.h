// SPDX-License-Identifier: LGPL-3.0-or-later
/// The monotonic clock, in nanoseconds.
#pragma once

#include <time.h>

#include <cstdint>

namespace mauve::guardian {

inline constexpr std::int64_t kMillisecond = 1'000'000;
inline constexpr std::int64_t kSecond = 1'000 * kMillisecond;

[[nodiscard]] inline std::int64_t now() {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return std::int64_t{time.tv_sec} * kSecond + time.tv_nsec;
}

[[nodiscard]] inline timespec duration(std::int64_t nanoseconds) {
  return {static_cast<time_t>(nanoseconds / kSecond), static_cast<long>(nanoseconds % kSecond)};
}

/// May return early.
inline void sleep_for(std::int64_t nanoseconds) {
  const timespec time = duration(nanoseconds);
  clock_nanosleep(CLOCK_MONOTONIC, 0, &time, nullptr);
}

}  // namespace mauve::guardian
