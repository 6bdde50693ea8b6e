// SPDX-License-Identifier: LGPL-3.0-or-later
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <limits>

#include "../../../plugins/supervision/areas.h"
#include "../../../plugins/supervision/progress.h"

namespace supervision {
namespace {

using namespace std::chrono_literals;  // NOLINT: durations

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr std::array<Area, 2> kAreas{{{{0.0, 0.0}, {8.0, 6.0}}, {{7.0, 0.0}, {20.0, 6.0}}}};

int area_at(double x, int before = kOutside, double margin = 0.5) {
  return area_of({x, 3.0, 0.0}, kAreas, before, margin);
}

TEST(Areas, AreNumberedFromOneAndTheFirstThatFitsCounts) {
  EXPECT_EQ(area_at(2.0), 1);
  EXPECT_EQ(area_at(7.5), 1) << "both hold it";
  EXPECT_EQ(area_at(9.0), 2);
  EXPECT_EQ(area_at(21.0), kOutside);
  EXPECT_EQ(area_of({2.0, 6.5, 0.0}, kAreas, kOutside, 0.5), kOutside);
}

TEST(Areas, AreLeftOnlyBeyondTheirMargin) {
  EXPECT_EQ(area_at(8.4, 1), 1);
  EXPECT_EQ(area_at(8.6, 1), 2);
  EXPECT_EQ(area_at(7.2, 2), 2) << "who comes from the second stays in it";
  EXPECT_EQ(area_at(6.4, 2), 1);
  EXPECT_EQ(area_at(20.4, 2), 2);
  EXPECT_EQ(area_at(20.6, 2), kOutside);
}

TEST(Areas, AreUnknownForAPoseThatIsNoNumber) {
  EXPECT_EQ(area_at(kNaN, 1), kNowhere);
  EXPECT_EQ(area_of({1.0, kNaN, 0.0}, kAreas, 1, 0.5), kNowhere);
}

TEST(Areas, ThatAreNoLongerThereAreForgotten) {
  EXPECT_EQ(area_of({2.0, 3.0, 0.0}, std::span(kAreas).first(1), 2, 0.5), 1);
  EXPECT_EQ(area_of({2.0, 3.0, 0.0}, {}, 1, 0.5), kOutside);
}

TEST(Areas, AreKeptForAWhileWhenThePoseIsNotKnown) {
  Sighting last;
  const mauve::Instant second = 1'000'000'000;
  EXPECT_EQ(follow(last, kNowhere, 2s, second), kNowhere) << "it was never seen";
  EXPECT_EQ(follow(last, 2, 2s, 10 * second), 2);
  EXPECT_EQ(follow(last, kNowhere, 2s, 11 * second), 2);
  EXPECT_EQ(follow(last, kNowhere, 2s, 12 * second), kNowhere);
  EXPECT_EQ(follow(last, kNowhere, 2s, 13 * second), kNowhere);
  EXPECT_EQ(follow(last, kOutside, 2s, 14 * second), kOutside);
  EXPECT_EQ(follow(last, kNowhere, 0s, 14 * second), kNowhere);
}

struct Drive {
  Progress progress;
  mauve::Instant now = 1'000;

  mauve::Duration at(double x, bool wants = true, mauve::Duration later = 1s) {
    now += later.count();
    return stays_for(progress, {x, 0.0, 0.0}, wants, 0.2, now);
  }
};

TEST(Progress, IsCountedFromTheLastPlaceThatTheRobotLeft) {
  Drive drive;
  EXPECT_EQ(drive.at(0.0), 0s);
  EXPECT_EQ(drive.at(0.1), 1s);
  EXPECT_EQ(drive.at(-0.1), 2s) << "to and fro is no progress";
  EXPECT_EQ(drive.at(0.3), 0s);
  EXPECT_EQ(drive.at(0.4), 1s);
}

TEST(Progress, IsNotAskedOfARobotThatDoesNotWantToMove) {
  Drive drive;
  EXPECT_EQ(drive.at(0.0, false), 0s);
  EXPECT_EQ(drive.at(0.0, false), 0s);
  EXPECT_EQ(drive.at(0.0), 0s);
  EXPECT_EQ(drive.at(0.0), 1s);
  EXPECT_EQ(drive.at(0.0, false), 0s);
}

TEST(Progress, IsNotMadeByAPoseThatIsNoNumber) {
  Drive drive;
  EXPECT_EQ(drive.at(0.0), 0s);
  EXPECT_EQ(drive.at(kNaN), 1s);
  EXPECT_EQ(drive.at(kNaN), 2s);
}

}  // namespace
}  // namespace supervision
