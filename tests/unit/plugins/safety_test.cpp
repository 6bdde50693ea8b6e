// SPDX-License-Identifier: LGPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "../../../plugins/drivers/recording/recording.h"
#include "../../../plugins/safety/zones.h"
#include "../../../plugins/world/world.h"
#include "support/test_data.h"

namespace {

using safety::Limits;
using safety::Zone;

rover::LaserScan view_of(const world::Disc& disc) {
  world::Map map;
  map.add(disc);
  world::Random random(1);
  rover::LaserScan scan;
  world::cast(map, {}, {}, random, scan);
  return scan;
}

TEST(SafetyPilot, SeesOnlyWhatStandsInItsCorridorAhead) {
  EXPECT_NEAR(safety::free_way(view_of({{3.0, 0.0}, 0.5}), 0.35), 2.5, 0.01);
  EXPECT_DOUBLE_EQ(safety::free_way(view_of({{3.0, 1.0}, 0.5}), 0.35), 8.0);
  EXPECT_DOUBLE_EQ(safety::free_way(view_of({{-1.0, 0.0}, 0.3}), 0.35), 8.0);
}

TEST(SafetyPilot, IgnoresErrorCodesAmongReturns) {
  rover::LaserScan scan = view_of({{3.0, 0.0}, 0.5});
  for (std::size_t beam = 0; beam < scan.ranges.size(); beam += 2) scan.ranges[beam] = 0.0F;

  EXPECT_NEAR(safety::free_way(scan, 0.35), 2.5, 0.01);
  EXPECT_FALSE(safety::blind(scan));
}

TEST(SafetyPilot, DistinguishesAnEmptyPlaceFromAScannerThatIsBlind) {
  rover::LaserScan scan = view_of({{30.0, 0.0}, 0.5});
  EXPECT_FALSE(safety::blind(scan)) << "it looked as far as it can and found nothing";
  EXPECT_TRUE(safety::blind({})) << "no beam at all";
  for (float& range : scan.ranges) range = 0.0F;
  EXPECT_TRUE(safety::blind(scan)) << "error codes only";
  for (float& range : scan.ranges) range = std::nanf("");
  EXPECT_TRUE(safety::blind(scan));
  scan.ranges[100] = std::numeric_limits<float>::infinity();
  EXPECT_FALSE(safety::blind(scan));
}

TEST(SafetyPilot, TrustsNoScanWithoutGeometry) {
  for (float rover::LaserScan::*number :
       {&rover::LaserScan::angle_min, &rover::LaserScan::angle_increment,
        &rover::LaserScan::range_min, &rover::LaserScan::range_max}) {
    rover::LaserScan scan = view_of({{0.8, 0.0}, 0.5});
    ASSERT_FALSE(safety::blind(scan));
    scan.*number = std::nanf("");
    EXPECT_TRUE(safety::blind(scan));
  }
}

TEST(SafetyPilot, StandsWhenTheCommandIsNoNumber) {
  for (const Zone zone : {Zone::clear, Zone::slow, Zone::stop}) {
    for (const rover::Velocity& odd :
         {rover::Velocity{std::nan(""), 0.1}, {0.1, std::nan("")}, {-HUGE_VAL, 0.1}}) {
      const rover::Velocity safe = safety::limited(odd, zone);
      EXPECT_EQ(safe.linear, 0.0);
      EXPECT_EQ(safe.angular, 0.0);
    }
  }
}

TEST(SafetyPilot, HalvesInTheSlowZoneAndStopsInTheStopZone) {
  EXPECT_EQ(safety::next_zone(Zone::clear, 3.01, Limits{}), Zone::clear);
  EXPECT_EQ(safety::next_zone(Zone::clear, 2.99, Limits{}), Zone::slow);
  EXPECT_EQ(safety::next_zone(Zone::clear, 0.99, Limits{}), Zone::stop);
  EXPECT_DOUBLE_EQ(safety::limited({0.8, 0.3}, Zone::clear).linear, 0.8);
  EXPECT_DOUBLE_EQ(safety::limited({0.8, 0.3}, Zone::slow).linear, 0.4);
  EXPECT_DOUBLE_EQ(safety::limited({0.8, 0.3}, Zone::stop).linear, 0.0);
}

TEST(SafetyPilot, LetsTheRobotTurnAndReverseInTheStopZone) {
  const rover::Velocity safe = safety::limited({-0.4, 1.0}, Zone::stop);

  EXPECT_DOUBLE_EQ(safe.linear, -0.4);
  EXPECT_DOUBLE_EQ(safe.angular, 1.0);
}

TEST(SafetyPilot, LeavesAZoneOnlyBeyondItsHysteresis) {
  EXPECT_EQ(safety::next_zone(Zone::stop, 1.05, Limits{}), Zone::stop);
  EXPECT_EQ(safety::next_zone(Zone::stop, 1.11, Limits{}), Zone::slow);
  EXPECT_EQ(safety::next_zone(Zone::slow, 3.2, Limits{}), Zone::slow);
  EXPECT_EQ(safety::next_zone(Zone::slow, 3.31, Limits{}), Zone::clear);
  EXPECT_EQ(safety::next_zone(Zone::stop, 3.2, Limits{}), Zone::slow);
}

TEST(SafetyPilot, SlowsAndStopsOnARealRecording) {
  const auto path = support::test_data("lidar/exp2.dat");
  if (!path) GTEST_SKIP() << support::kNoTestData;
  const auto recording = drivers::Recording::load(*path);
  ASSERT_TRUE(recording);
  rover::LaserScan scan;
  Zone zone = Zone::clear;
  int count[3] = {};

  for (std::size_t i = 0; i < recording->size(); ++i) {
    recording->show(i, scan);
    zone = safety::next_zone(zone, safety::free_way(scan, 0.2), Limits{});
    ++count[static_cast<int>(zone)];
  }

  EXPECT_GT(count[static_cast<int>(Zone::slow)], 0);
  EXPECT_GT(count[static_cast<int>(Zone::stop)], 0);
}

}  // namespace
