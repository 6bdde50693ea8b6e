// SPDX-License-Identifier: LGPL-3.0-or-later
#include <gtest/gtest.h>

#include <memory>

#include <mauve/test_kit.h>

#include "../../../plugins/navigation/navigation.h"
#include "rt/heap_probe.h"

namespace {

using namespace std::chrono_literals;  // NOLINT: durations
using navigation::Navigation;
using navigation::NavigationShell;

TEST(NavigationHeap, IsLeftAloneByEveryJob) {
  const auto bench = std::make_unique<mauve::CoreBench<NavigationShell, Navigation>>();
  ASSERT_TRUE(bench->configure());
  const auto map = std::make_unique<navigation::OccupancyGrid>();
  map->time = 1.0;
  map->resolution = 0.1;
  map->width = map->height = 200;
  map->cells.resize(40'000);
  bench->give(bench->shell().map, *map);
  bench->give(bench->shell().pose, navigation::Pose2D{2.0, 2.0, 0.0});
  bench->give(bench->shell().goal, navigation::Point2D{18.0, 2.0});
  rover::LaserScan scan;
  scan.range_max = 8.0F;
  scan.ranges.push_back(2.0F);
  bench->give(bench->shell().scan, scan);
  Navigation& core = bench->core();
  const std::size_t before = heap::calls();

  heap::watch_this_thread(true);
  core.poll_goal();
  core.make_plan();
  bench->advance(2s);
  core.follow();
  core.make_plan();
  core.stand();
  core.finish();
  heap::watch_this_thread(false);

  EXPECT_EQ(heap::calls(), before);
  EXPECT_FALSE(core.no_way());
}

}  // namespace
