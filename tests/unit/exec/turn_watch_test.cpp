// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/run/turn_watch.h"

#include <gtest/gtest.h>

#include <limits>

namespace mauve::exec {
namespace {

constexpr Duration kLook{10ms};

/// A component as [guard] sees it: it looks every 10 ms.
struct Watched {
  TurnWatch watch;
  Instant now = 1'000'000'000;
  TurnWatch::Facts facts{now, Duration{0}, 150ms};
  bool asleep = false;

  bool look(Duration later = kLook) {
    now += later.count();
    return watch.starved(now, facts, [this] { return asleep; }) == Duration{0};
  }
  /// Looks while nothing changes, at most for `time`; how long all was well.
  Duration well_for(Duration time) {
    const Instant begin = now;
    while (Duration{now - begin} < time && look()) {
    }
    return Duration{now - begin};
  }
  /// One job at each release, which uses the processor for 1 ms.
  void run_jobs(int count, Duration period) {
    for (int i = 0; i < count; ++i) {
      facts.release = now + period.count();
      EXPECT_TRUE(look(period));
      facts.used += 1ms;
      EXPECT_TRUE(look(Duration{1ms}));
    }
    facts.release = now + period.count();
    EXPECT_TRUE(look(period));
  }
};

TEST(TurnWatch, BlamesAThreadThatGetsNoProcessorWhenItIsDue) {
  Watched drives;
  drives.run_jobs(20, 15ms);

  const Duration well = drives.well_for(10s);

  EXPECT_GE(well, TurnWatch::kShortest);
  EXPECT_LE(well, TurnWatch::kShortest + kLook);
}

TEST(TurnWatch, BlamesAThreadThatLosesTheProcessorWithinItsJob) {
  Watched drives;
  drives.run_jobs(20, 15ms);
  drives.facts.used += 2ms;  // the job began
  EXPECT_TRUE(drives.look());

  EXPECT_LE(drives.well_for(10s), TurnWatch::kShortest + kLook);
}

TEST(TurnWatch, LetsALongJobUseTheProcessor) {
  Watched drives;
  drives.run_jobs(20, 15ms);

  for (int i = 0; i < 100; ++i) {
    drives.facts.used += 3ms;
    EXPECT_TRUE(drives.look());
  }
}

TEST(TurnWatch, LetsAJobSleep) {
  Watched drives;
  drives.run_jobs(20, 15ms);
  drives.asleep = true;

  EXPECT_EQ(drives.well_for(1s), Duration{1s});
}

TEST(TurnWatch, WaitsForALongPeriod) {
  Watched drives;
  drives.facts.release = drives.now + Duration{10s}.count();

  EXPECT_EQ(drives.well_for(10s - kLook), 10s - kLook);
}

TEST(TurnWatch, LetsAComponentWithALongPeriodBeLateUntilTheNextRelease) {
  Watched drives;
  drives.run_jobs(20, 100ms);

  const Duration well = drives.well_for(10s);

  EXPECT_GE(well, 90ms);
  EXPECT_LE(well, 110ms);
}

TEST(TurnWatch, BlamesNoLaterThanAfterTheBoundOfAJob) {
  Watched drives;
  drives.facts.bound = 80ms;
  drives.run_jobs(20, 1s);

  EXPECT_LE(drives.well_for(10s), 80ms + kLook);
}

TEST(TurnWatch, CountsNoTimeInWhichNobodyLooked) {
  Watched drives;
  drives.run_jobs(20, 15ms);

  EXPECT_TRUE(drives.look(10s)) << "the machine stood still";

  EXPECT_LE(drives.well_for(10s), TurnWatch::kShortest - TurnWatch::kOnTime + kLook);
}

TEST(TurnWatch, BlamesNoComponentThatStandsAndForgetsHowLongItStood) {
  Watched drives;
  drives.run_jobs(20, 15ms);
  drives.facts.release = std::numeric_limits<Instant>::max() / 2;
  EXPECT_EQ(drives.well_for(60s), Duration{60s});
  drives.facts.release = drives.now;

  EXPECT_LE(drives.well_for(10s), TurnWatch::kShortest + kLook);
}

}  // namespace
}  // namespace mauve::exec
