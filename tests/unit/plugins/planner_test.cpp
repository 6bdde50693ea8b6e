// SPDX-License-Identifier: LGPL-3.0-or-later
#include "../../../plugins/navigation/planner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <vector>

#include "../../../plugins/navigation/map_file.h"
#include "../../../plugins/world/random.h"
#include "support/grid_reference.h"

namespace {

using navigation::Answer;
using navigation::Frame;
using navigation::OccupancyGrid;
using navigation::Planner;
using navigation::Point2D;
using rover::Path;
using support::length;
using Reference = support::GridReference;

using support::kFarAway;

std::unique_ptr<OccupancyGrid> empty_grid(int width, int height, double resolution) {
  auto grid = std::make_unique<OccupancyGrid>();
  grid->width = width;
  grid->height = height;
  grid->resolution = resolution;
  grid->cells.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  return grid;
}

void fill(OccupancyGrid& grid, int x0, int y0, int x1, int y1, std::int8_t value) {
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) {
      grid.cells[static_cast<std::size_t>(y * grid.width + x)] = value;
    }
  }
}

std::unique_ptr<OccupancyGrid> building() {
  auto grid = std::make_unique<OccupancyGrid>();
  EXPECT_TRUE(navigation::load_map(
      (std::filesystem::path(MAUVE_SOURCE_DIR) / "etc/maps/building.yaml").string(), *grid));
  return grid;
}

/// Looks at the way every centimetre.
bool touches(const Reference& reference, const Point2D& start, const Path& path) {
  Point2D at = start;
  for (const Point2D& point : path.points) {
    const int steps = 1 + static_cast<int>(std::hypot(point.x - at.x, point.y - at.y) / 0.01);
    for (int i = 0; i <= steps; ++i) {
      const double share = static_cast<double>(i) / steps;
      if (reference.blocked({at.x + share * (point.x - at.x), at.y + share * (point.y - at.y)})) {
        return true;
      }
    }
    at = point;
  }
  return false;
}

TEST(Distances, AreThoseToTheNearestSolidCell) {
  world::Random random(3);
  const auto distances = std::make_unique<navigation::Distances>(30 * 30);
  for (int round = 0; round < 60; ++round) {
    const int width = 1 + static_cast<int>(random.uniform(0.0, 30.0));
    const int height = 1 + static_cast<int>(random.uniform(0.0, 30.0));
    const auto grid = empty_grid(width, height, 1.0);
    const double share = random.uniform(0.0, 0.2);
    for (std::int8_t& cell : grid->cells) cell = random.uniform(0.0, 1.0) < share ? 1 : 0;
    const Frame frame = *Frame::of(*grid);
    const bool border = round % 2 == 0;

    distances->measure(frame, border, [&](std::size_t i) { return grid->cells[i] != 0; });

    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        int least = navigation::Distances::kFar;
        for (int v = -1; v <= height; ++v) {
          for (int u = -1; u <= width; ++u) {
            const bool solid = frame.inside(u, v) ? grid->cells[frame.index(u, v)] != 0 : border;
            if (solid) least = std::min(least, (u - x) * (u - x) + (v - y) * (v - y));
          }
        }
        ASSERT_EQ(distances->squared(frame.index(x, y)), least) << x << ", " << y;
      }
    }
  }
}

TEST(Planner, FindsWaysAsShortAsThoseOfTheGridAndTouchesNothing) {
  const auto grid = building();
  const Reference reference(*grid, 0.45);
  const auto planner = std::make_unique<Planner>(1024UL * 1024UL);
  ASSERT_TRUE(planner->set_map(*grid, {0.45, false}));
  world::Random random(7);
  Path path;
  int reachable = 0;
  for (int source = 0; source < 10; ++source) {
    const Point2D start = reference.random_free(random);
    const auto distances = reference.distances_from(start);
    for (int target = 0; target < 10; ++target) {
      const Point2D goal = reference.random_free(random);
      const double best = distances[reference.frame().index(reference.frame().cells(goal))];

      const Answer answer = planner->plan(start, goal, path);

      ASSERT_EQ(answer == Answer::found, best < kFarAway) << to_string(answer);
      if (answer != Answer::found) continue;
      ++reachable;
      EXPECT_LE(length(start, path), 1.05 * best + 1e-9);
      EXPECT_FALSE(touches(reference, start, path)) << source << ", " << target;
      EXPECT_NEAR(path.points[path.points.size() - 1].x, goal.x, 1e-9);
      EXPECT_NEAR(path.points[path.points.size() - 1].y, goal.y, 1e-9);
    }
  }
  EXPECT_GT(reachable, 90);
}

TEST(Planner, AnswersTheSameQuestionTheSameWay) {
  const auto grid = building();
  const auto first = std::make_unique<Planner>(1024UL * 1024UL);
  const auto second = std::make_unique<Planner>(1024UL * 1024UL);
  ASSERT_TRUE(first->set_map(*grid, {}));
  ASSERT_TRUE(second->set_map(*grid, {}));
  Path a;
  Path b;
  ASSERT_EQ(second->plan({12, 5}, {-2, 8}, b), Answer::found) << "something else before";
  ASSERT_EQ(first->plan({0, 0}, {18, -2}, a), Answer::found);
  ASSERT_EQ(second->plan({0, 0}, {18, -2}, b), Answer::found);

  ASSERT_EQ(a.points.size(), b.points.size());
  for (std::size_t i = 0; i < a.points.size(); ++i) {
    EXPECT_EQ(a.points[i].x, b.points[i].x);
    EXPECT_EQ(a.points[i].y, b.points[i].y);
  }
}

TEST(Planner, PlansThroughTheLargestMapAndRefusesOneThatIsLargerThanItsRoom) {
  const auto hall = empty_grid(2048, 2048, 0.05);
  ASSERT_EQ(hall->cells.size(), 2048UL * 2048UL);
  const auto small = std::make_unique<Planner>(hall->cells.size() - 1);
  const auto large = std::make_unique<Planner>(hall->cells.size());
  Path path;

  EXPECT_FALSE(small->set_map(*hall, {}));
  EXPECT_EQ(small->plan({1, 1}, {101, 101}, path), Answer::too_large);
  ASSERT_TRUE(large->set_map(*hall, {}));
  EXPECT_EQ(large->plan({1, 1}, {101, 101}, path), Answer::found);
  EXPECT_EQ(path.points.size(), 1U);
}

TEST(Planner, GoesStraightWhereNothingIsInTheWay) {
  const auto planner = std::make_unique<Planner>(1024UL * 1024UL);
  ASSERT_TRUE(planner->set_map(*building(), {}));
  Path path;

  ASSERT_EQ(planner->plan({0.01, 0.02}, {6.03, -1.01}, path), Answer::found);

  ASSERT_EQ(path.points.size(), 1U);
  EXPECT_TRUE(planner->free({0, 0}, {6, -1}));
  EXPECT_FALSE(planner->free({0, 0}, {12, 5})) << "through the wall";
  EXPECT_FALSE(planner->free({0, 0}, {-40, 0})) << "off the map";
}

TEST(Planner, LeavesAPlaceThatIsTooNearToAWall) {
  const auto planner = std::make_unique<Planner>(1024UL * 1024UL);
  const auto grid = building();
  ASSERT_TRUE(planner->set_map(*grid, {0.45, false}));
  const Reference walls(*grid, 0.0);
  Path path;

  ASSERT_EQ(planner->plan({7.8, 0.0}, {7.8 + 0.9, -1.0}, path), Answer::found);

  ASSERT_GT(path.points.size(), 2U) << "round by the door, not through the wall";
  EXPECT_LT(path.points[0].x, 7.6) << "away from the wall first";
  EXPECT_FALSE(touches(walls, {7.8, 0.0}, path));
  EXPECT_EQ(planner->plan({8.1, 0.0}, {0.0, 0.0}, path), Answer::enclosed) << "in the wall";
  EXPECT_TRUE(path.points.empty());
}

TEST(Planner, LeavesWhatHasComeTooNear) {
  const auto planner = std::make_unique<Planner>(1024UL * 1024UL);
  ASSERT_TRUE(planner->set_map(*empty_grid(100, 100, 0.1), {0.5, false}));
  planner->block({5.3, 5.0}, 10.0);
  Path path;

  ASSERT_EQ(planner->plan({5.0, 5.0}, {8.0, 5.0}, path), Answer::found);

  ASSERT_GT(path.points.size(), 2U);
  EXPECT_GT(std::hypot(path.points[0].x - 5.3, path.points[0].y - 5.0), 0.5);
  EXPECT_FALSE(planner->obstructed(path.points[0], path.points[1]));
}

TEST(Planner, KnowsMapsThatLieAskew) {
  const auto grid = building();
  grid->origin.heading = 0.7;
  const Reference reference(*grid, 0.45);
  const auto planner = std::make_unique<Planner>(1024UL * 1024UL);
  ASSERT_TRUE(planner->set_map(*grid, {0.45, false}));
  const Point2D start = reference.frame().world({80.5, 100.5});
  const Point2D goal = reference.frame().world({400.5, 250.5});
  Path path;

  ASSERT_EQ(planner->plan(start, goal, path), Answer::found);

  EXPECT_FALSE(touches(reference, start, path));
  EXPECT_GT(path.points.size(), 2U);
}

TEST(Planner, SaysNoWayWhenThereIsNone) {
  const auto grid = empty_grid(200, 100, 0.1);
  fill(*grid, 100, 0, 101, 100, 100);
  const auto planner = std::make_unique<Planner>(1024UL * 1024UL);
  Path path;
  EXPECT_EQ(planner->plan({1, 1}, {2, 2}, path), Answer::no_map);
  ASSERT_TRUE(planner->set_map(*grid, {0.3, false}));

  EXPECT_EQ(planner->plan({5, 5}, {15, 5}, path), Answer::no_way);
  EXPECT_TRUE(path.points.empty());
  EXPECT_EQ(planner->plan({5, 5}, {9.9, 5}, path), Answer::goal_blocked);
  EXPECT_EQ(planner->plan({5, 5}, {25, 5}, path), Answer::outside);
  EXPECT_EQ(planner->plan({5, std::nan("")}, {6, 5}, path), Answer::outside);
  EXPECT_EQ(planner->plan({5, 5}, {5, kFarAway}, path), Answer::outside);
  EXPECT_EQ(planner->plan({5, 5}, {8, 8}, path), Answer::found) << "and goes on";
}

TEST(Planner, DoesNotDriveThroughTheUnknownUnlessItMay) {
  const auto grid = empty_grid(100, 100, 0.1);
  fill(*grid, 45, 0, 55, 100, -1);
  const auto planner = std::make_unique<Planner>(1024UL * 1024UL);
  Path path;

  ASSERT_TRUE(planner->set_map(*grid, {0.3, false}));
  EXPECT_EQ(planner->plan({2, 5}, {8, 5}, path), Answer::no_way);
  ASSERT_TRUE(planner->set_map(*grid, {0.3, true}));
  EXPECT_EQ(planner->plan({2, 5}, {8, 5}, path), Answer::found);
}

TEST(Planner, GoesRoundWhatIsNotOnTheMapUntilItsTimeIsOver) {
  const auto planner = std::make_unique<Planner>(1024UL * 1024UL);
  ASSERT_TRUE(planner->set_map(*empty_grid(100, 100, 0.1), {0.5, false}));
  Path path;
  planner->block({5, 5}, 10.0);
  planner->block({5, 5.5}, 20.0);

  EXPECT_FALSE(planner->free({2, 5}, {8, 5}));
  ASSERT_EQ(planner->plan({2, 5}, {8, 5}, path), Answer::found);
  EXPECT_GT(path.points.size(), 1U);
  EXPECT_GT(length({2, 5}, path), 6.05);

  planner->forget(10.0);
  EXPECT_TRUE(planner->free({2, 4.9}, {8, 4.9}));
  EXPECT_FALSE(planner->free({2, 5.5}, {8, 5.5})) << "the other is still there";
  planner->forget(20.0);
  EXPECT_TRUE(planner->free({2, 5.5}, {8, 5.5}));
}

TEST(Planner, TakesMoreObstaclesThanItHasRoomFor) {
  const auto planner = std::make_unique<Planner>(1024UL * 1024UL);
  ASSERT_TRUE(planner->set_map(*empty_grid(100, 100, 0.1), {0.0, false}));
  for (int i = 0; i < 5000; ++i)
    planner->block({0.1 * (i % 100) + 0.05, 0.1 * (i / 100) + 0.05}, 1);

  planner->forget(2.0);

  EXPECT_TRUE(planner->free({0.05, 0.05}, {9.95, 9.95}));
}

TEST(Planner, RefusesAWayWithMorePointsThanAPathHasRoomFor) {
  const auto grid = empty_grid(1024, 16, 1.0);
  for (int wall = 1; wall < 512; ++wall) {
    const int low = wall % 2 == 0 ? 0 : 1;
    fill(*grid, 2 * wall, low, 2 * wall + 1, low + 15, 100);
  }
  const auto planner = std::make_unique<Planner>(1024UL * 1024UL);
  ASSERT_TRUE(planner->set_map(*grid, {0.0, false}));
  Path path;

  EXPECT_EQ(planner->plan({0.5, 8.5}, {1023.5, 8.5}, path), Answer::too_winding);
  EXPECT_TRUE(path.points.empty());
}

TEST(Planner, RefusesMapsThatAreNone) {
  const auto planner = std::make_unique<Planner>(1024UL * 1024UL);
  const auto grid = empty_grid(10, 10, 0.1);
  const auto refused = [&](auto change) {
    const auto copy = std::make_unique<OccupancyGrid>(*grid);
    change(*copy);
    return !planner->set_map(*copy, {0.3, false});
  };

  EXPECT_TRUE(refused([](OccupancyGrid& map) { map.resolution = 0.0; }));
  EXPECT_TRUE(refused([](OccupancyGrid& map) { map.resolution = std::nan(""); }));
  EXPECT_TRUE(refused([](OccupancyGrid& map) { map.resolution = 0.001; })) << "too fine";
  EXPECT_TRUE(refused([](OccupancyGrid& map) { map.origin.x = kFarAway; }));
  EXPECT_TRUE(refused([](OccupancyGrid& map) { map.width = -10; }));
  EXPECT_TRUE(refused([](OccupancyGrid& map) { map.cells.resize(99); }));
  EXPECT_TRUE(refused([](OccupancyGrid& map) { map.width = map.height = 65536; }));
  EXPECT_FALSE(planner->has_map());
  EXPECT_TRUE(planner->set_map(*grid, {0.3, false}));
}

}  // namespace
