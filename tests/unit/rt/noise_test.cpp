// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/machine/noise.h"

#include <atomic>
#include <thread>

#include <gtest/gtest.h>

#include "support/eventually.h"

#include <mauve/host/clock.h>

namespace mauve::rt {
namespace {

constexpr Instant kSecond = 1'000'000'000;
constexpr Instant kBegin = 1'000 * kSecond;

/// `count` wake-ups, a second apart, each so much later than asked for.
void wake(NoiseOfCpu& noise, Instant from, int count, Duration late) {
  for (int i = 0; i < count; ++i) {
    const Instant due = from + i * kSecond;
    noise.add(due, due + late.count());
  }
}

TEST(NoiseOfCpu, IsADistributionWithItsAge) {
  NoiseOfCpu noise(60us);
  wake(noise, kBegin, 9, 10us);
  wake(noise, kBegin + 9 * kSecond, 1, 100us);

  const WakeNoise seen = noise.look(kBegin + 30 * kSecond);

  EXPECT_EQ(seen.late.count, 10U);
  EXPECT_EQ(seen.late.max, 100us);
  EXPECT_EQ(seen.beyond, 1U) << "later than assumed";
  EXPECT_NEAR(static_cast<double>(seen.span.count()), 30e9, 1e6);
  EXPECT_EQ(seen.worst, 100us);
  EXPECT_NEAR(static_cast<double>(seen.worst_ago.count()), 21e9, 1e6);
}

TEST(NoiseOfCpu, ForgetsAllButTheWorstAfterTwoMinutes) {
  NoiseOfCpu noise(60us);
  wake(noise, kBegin, 1, 5ms);
  wake(noise, kBegin + kSecond, 150, 10us);

  const WakeNoise seen = noise.look(kBegin + 151 * kSecond);

  EXPECT_EQ(seen.late.max, 10us);
  EXPECT_EQ(seen.beyond, 0U);
  EXPECT_LE(seen.span, 120s);
  EXPECT_GE(seen.late.count, 60U) << "at least the last minute";
  EXPECT_EQ(seen.worst, 5ms);
  EXPECT_GE(seen.worst_ago, 150s);
}

TEST(NoiseOfCpu, NeverShowsMoreLateWakeUpsThanWakeUps) {
  NoiseOfCpu noise(1us);
  std::atomic<bool> over{false};
  std::thread probe([&] {
    // A second apart, so that blocks are cleared under the looks too.
    for (int n = 0; !over; ++n) noise.add(kBegin + n * kSecond, kBegin + n * kSecond + 30'000);
  });

  for (int look = 0; look < 20'000; ++look) {
    const WakeNoise seen = noise.look(kBegin);
    if (seen.beyond <= seen.late.count) continue;
    ADD_FAILURE() << seen.beyond << " of " << seen.late.count;
    break;
  }

  over = true;
  probe.join();
}

TEST(NoiseOfCpu, ReportsForHowLongTheProbeWasHeldUp) {
  NoiseOfCpu noise(60us);
  wake(noise, kBegin, 1, 190us);
  EXPECT_EQ(noise.held_up_since(kBegin - kSecond), 0us) << "any thread may be so late";

  wake(noise, kBegin + kSecond, 1, 2ms);

  EXPECT_EQ(noise.held_up_since(kBegin + kSecond), 2ms);
  EXPECT_EQ(noise.held_up_since(kBegin + kSecond + 2'000'000), 2ms) << "until the probe ran";
  EXPECT_EQ(noise.held_up_since(kBegin + kSecond + 2'000'001), 0us);
}

TEST(NoiseOfCpu, HoldsNoProbeForHeldUpThatWakesUpAsAssumed) {
  NoiseOfCpu noise(1ms);
  wake(noise, kBegin, 1, 1900us);
  EXPECT_EQ(noise.held_up_since(kBegin), 0us) << "within twice the assumed time";
}

TEST(Noise, KnowsNothingOfCpusWithoutAProbe) {
  const Noise noise(60us);

  EXPECT_EQ(noise.held_up_since(0), 0us);
  EXPECT_FALSE(noise.stands_still({0, 1, 4711, -1}, MonotonicClock().now()));
  EXPECT_TRUE(noise.look(MonotonicClock().now()).empty());
}

TEST(Noise, IsReportedByAProbeOnEachCpuThatIsWatched) {
  if (!may_use_fifo(99)) GTEST_SKIP() << "NOT TESTED: no SCHED_FIFO here";
  Noise noise(60us);
  const auto cpus = usable_cpus();
  noise.watch({});
  noise.watch(cpus);

  EXPECT_TRUE(test::eventually([&] {
    const auto rows = noise.look(MonotonicClock().now());
    return rows.size() == cpus.size() && rows[0].late.count > 10;
  })) << "one probe a CPU";
  EXPECT_TRUE(test::eventually([&] { return !noise.stands_still(cpus, MonotonicClock().now()); }));

  noise.stop();
  EXPECT_TRUE(test::eventually([&] { return noise.stands_still(cpus, MonotonicClock().now()); }))
      << "no probe runs";
  EXPECT_GT(noise.look(MonotonicClock().now())[0].late.count, 10U) << "what was seen stays";
}

TEST(Noise, IgnoresNumbersThatAreNoCpu) {
  Noise noise(60us);
  noise.watch({1'000'000, -1});

  EXPECT_TRUE(noise.look(MonotonicClock().now()).empty());
}

}  // namespace
}  // namespace mauve::rt
