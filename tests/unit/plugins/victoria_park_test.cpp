// SPDX-License-Identifier: LGPL-3.0-or-later
/// The filter on the truck in Victoria Park. The tests check its error after half a minute without
/// satellites, its own estimate of that error, and its reaction to positions that jump.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "support/sanitized.h"
#include "support/test_data.h"
#include "support/victoria_park.h"

namespace {

using namespace support::park;

constexpr double kSettled = 60.0;  // s from the start of the recording
constexpr double kLimit = 5.991;   // chi-square, two degrees of freedom, 95 %

class VictoriaPark : public testing::Test {
 protected:
  void SetUp() override {
    const auto folder = support::test_data("victoria_park");
    if (!folder) GTEST_SKIP() << support::kNoTestData;
    recording_ = read(*folder);
    ASSERT_EQ(recording_.wheels.size(), 61'945u);
    ASSERT_GT(recording_.fixes.size(), 4000u);
    from_ = recording_.wheels.front().time + kSettled;
    to_ = recording_.wheels.back().time;
  }

  Recording recording_;
  double from_ = 0.0;
  double to_ = 0.0;
};

TEST_F(VictoriaPark, IsFoundAgainWithoutSatellites) {
  std::vector<double> errors;
  double admitted = 0.0;
  double inside = 0.0;
  double fixes = 0.0;
  double seconds = 0.0;
  constexpr int kRuns = support::kSanitized ? 2 : 10;
  for (std::uint64_t seed = 1; seed <= kRuns; ++seed) {
    const Replay run = replay(recording_, Outages::random(seed, from_, to_), truck());
    seconds += run.seconds;
    for (const Sample& sample : run.samples) {
      if (sample.fix.time < from_) continue;
      if (sample.outage >= 20.0) {
        errors.push_back(sample.error);
        admitted += sample.surprise < kLimit ? 1.0 : 0.0;
      }
      if (sample.outage >= 0.0) continue;
      ++fixes;
      inside += sample.nis < kLimit ? 1.0 : 0.0;
    }
  }
  ASSERT_GT(errors.size(), 300u * kRuns);
  RecordProperty("p50", std::to_string(quantile(errors, 0.5)));
  RecordProperty("p90", std::to_string(quantile(errors, 0.9)));
  EXPECT_LE(quantile(errors, 0.5), 5.0);
  EXPECT_LE(quantile(errors, 0.9), 15.0);
  EXPECT_GE(admitted / static_cast<double>(errors.size()), 0.85) << "inside the 95 % ellipse";
  EXPECT_GE(inside / fixes, 0.90);
  EXPECT_LE(inside / fixes, 0.99);
  if constexpr (support::kSanitized) return;  // it takes ten times as long
  EXPECT_GT(kRuns * recording_.seconds() / seconds, 100.0) << "times as fast as the recording";
}

TEST_F(VictoriaPark, EveryJumpOfTheSatellitesIsGatedAndCounted) {
  const Replay run = replay(recording_, {}, truck());
  std::size_t jumps = 0;
  std::size_t rejected = 0;
  for (std::size_t i = 1; i < run.samples.size(); ++i) {
    const Sample& before = run.samples[i - 1];
    const Sample& sample = run.samples[i];
    rejected += sample.rejected ? 1 : 0;
    const double dt = sample.fix.time - before.fix.time;
    const double way = std::hypot(sample.fix.x - before.fix.x, sample.fix.y - before.fix.y);
    // Two metres farther than the truck can drive, from a position that the filter believed.
    if (before.rejected || dt > 5.0 || way < 7.0 * dt + 2.0) continue;
    ++jumps;
    EXPECT_TRUE(sample.rejected) << "at " << sample.fix.time << " s by " << way << " m";
  }
  RecordProperty("jumps", std::to_string(jumps));
  EXPECT_GE(jumps, 15u);
  EXPECT_EQ(run.last.rejected, rejected);
  EXPECT_GT(run.last.accepted, 20 * run.last.rejected);
}

TEST_F(VictoriaPark, LearnsTheSteeringOfTheTruck) {
  const Replay run = replay(recording_, {}, truck());

  EXPECT_TRUE(run.last.aligned);
  EXPECT_NEAR(run.last.mean[localization::kTurnScale], -0.047, 0.03);
  EXPECT_NEAR(run.last.mean[localization::kCurvature], -0.0017, 0.001);
  EXPECT_NEAR(run.last.mean[localization::kScale], 0.0, 0.02);
}

}  // namespace
