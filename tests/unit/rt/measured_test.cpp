// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/time/measured.h"

#include <gtest/gtest.h>

#include <thread>

namespace mauve::rt {
namespace {

/// A job of 100 ns.
void job(Measured& measured) {
  JobTimes& here = measured.here();
  here.clean.add(100);
  here.states[0].add(100, false);
  here.missed.store(here.missed.load() + 1);
}

std::uint64_t jobs(const Measured& measured) { return measured.shown().clean.look().count; }

TEST(Measured, CountsAnewAfterAResetAgainAndAgain) {
  Measured measured(1);
  for (int round = 0; round < 5; ++round) {
    job(measured);
    job(measured);
    EXPECT_EQ(jobs(measured), 2U);

    measured.reset();

    EXPECT_EQ(jobs(measured), 0U);
    EXPECT_EQ(measured.shown().missed, 0U);
    EXPECT_EQ(measured.shown().states[0].clean.look().count, 0U);
  }
}

TEST(Measured, IsResetOnceWhenNoJobCameBetween) {
  Measured measured(1);
  measured.reset();
  job(measured);
  measured.reset();
  measured.reset();
  measured.reset();
  job(measured);

  EXPECT_EQ(jobs(measured), 1U);
}

TEST(Measured, LetsAJobUnderWayCountToWhatWasBefore) {
  Measured measured(1);
  JobTimes& here = measured.here();

  measured.reset();
  here.clean.add(100);
  measured.reset();
  here.clean.add(100);

  EXPECT_EQ(jobs(measured), 0U);
  job(measured);
  EXPECT_EQ(jobs(measured), 1U);
}

TEST(Measured, ShowsOnlyLaterJobsWhenResetBesideThem) {
  constexpr int kJobs = 100'000;
  Measured measured(1);
  std::atomic<int> done{0};
  std::thread writer([&] {
    for (int i = 0; i < kJobs; ++i) {
      job(measured);
      done = i + 1;
    }
  });
  while (done < kJobs) {
    const auto before = static_cast<std::uint64_t>(done);
    measured.reset();
    const std::uint64_t shown = jobs(measured);
    EXPECT_LE(shown, static_cast<std::uint64_t>(done) - before + 1);
  }
  writer.join();

  measured.reset();
  job(measured);
  EXPECT_EQ(jobs(measured), 1U);
}

TEST(Tally, KnowsCountSumAndTheLongest) {
  Tally tally;
  tally.add(5);
  tally.add({2, Duration{20}, Duration{15}});

  EXPECT_EQ(tally.look().count, 3U);
  EXPECT_EQ(tally.look().sum, Duration{25});
  EXPECT_EQ(tally.look().longest, Duration{15});
}

}  // namespace
}  // namespace mauve::rt
