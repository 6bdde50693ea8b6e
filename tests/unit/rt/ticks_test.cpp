// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/time/ticks.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include <mauve/host/clock.h>

namespace mauve::rt {
namespace {

constexpr const char* kNotTied = "NOT TESTED: ticks are not tied where the clock is not the TSC";

void until(Instant instant) {
  while (MonotonicClock().now() < instant) std::this_thread::sleep_for(1ms);
}

/// As far from the clock as it may be when the machine stands still between the two readings.
Instant distance() {
  Instant least = Duration{1s}.count();
  for (int i = 0; i < 100; ++i) {
    const Instant fast = fast_now();
    least = std::min(least, std::abs(MonotonicClock().now() - fast));
  }
  return least;
}

TEST(Ticks, AreTheClockBeforeTheyAreTiedAndAfterwards) {
  EXPECT_LT(distance(), 1'000'000);
  tie_ticks();
  until(MonotonicClock().now() + 150'000'000);
  tie_ticks();

  EXPECT_LT(distance(), 1'000'000) << (ticks_are_tied() ? "tied" : "not tied on this machine");
  if (!ticks_are_tied() && !HasFailure()) GTEST_SKIP() << kNotTied;
}

TEST(Ticks, StayWithTheClockWhileTheyAreTiedAnew) {
  std::atomic<bool> done{false};
  std::atomic<Instant> farthest{0};
  std::atomic<int> looks{0};
  std::thread reader([&] {
    while (!done) {
      const Instant before = MonotonicClock().now();
      const Instant fast = fast_now();
      const Instant after = MonotonicClock().now();
      const Instant far = std::max(before - fast, fast - after);
      if (far > farthest) farthest = far;
      ++looks;
    }
  });
  const Instant end = MonotonicClock().now() + 1'300'000'000;
  while (MonotonicClock().now() < end) {
    tie_ticks();
    std::this_thread::sleep_for(1ms);
  }
  done = true;
  reader.join();

  EXPECT_GT(looks, 0);
  EXPECT_LT(farthest, 1'000'000);
  if (!ticks_are_tied() && !HasFailure()) GTEST_SKIP() << kNotTied;
}

}  // namespace
}  // namespace mauve::rt
