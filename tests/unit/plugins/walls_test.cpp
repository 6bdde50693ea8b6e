// SPDX-License-Identifier: LGPL-3.0-or-later
#include "../../../plugins/world/walls.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>

#include "../../../plugins/navigation/map_file.h"
#include "../../../plugins/world/world.h"

namespace {

using navigation::Frame;
using rover::LaserScan;
using rover::OccupancyGrid;
using rover::Point2D;
using rover::Pose2D;

std::unique_ptr<OccupancyGrid> building(double heading) {
  auto grid = std::make_unique<OccupancyGrid>();
  EXPECT_TRUE(navigation::load_map(
      (std::filesystem::path(MAUVE_SOURCE_DIR) / "etc/maps/building.yaml").string(), *grid));
  grid->origin.heading = heading;
  return grid;
}

bool is_wall(const OccupancyGrid& grid, const Frame& frame, const Point2D& at) {
  const Point2D cell = frame.cells(at);
  return frame.inside(cell) && grid.cells[frame.index(cell)] == 100;
}

/// Millimetre by millimetre.
double walked(const OccupancyGrid& grid, const Frame& frame, const Pose2D& from, double angle,
              double most) {
  for (double range = 0.0; range < most; range += 0.001) {
    const Point2D at{from.x + range * std::cos(angle), from.y + range * std::sin(angle)};
    if (is_wall(grid, frame, at)) return range;
  }
  return most;
}

TEST(Walls, StopEveryBeamWhereTheyStand) {
  for (const double heading : {0.0, 0.4}) {
    const auto grid = building(heading);
    const Frame frame = *Frame::of(*grid);
    const auto walls = std::make_unique<world::Walls>();
    ASSERT_TRUE(walls->set(*grid));
    world::Random random(5);
    LaserScan scan;
    int apart = 0;
    for (int place = 0; place < 6; ++place) {
      const Point2D cell{random.uniform(-40.0, 520.0), random.uniform(-40.0, 360.0)};
      const Point2D at = frame.world(cell);
      const Pose2D pose{at.x, at.y, random.uniform(-3.0, 3.0)};
      world::cast({}, pose, {0.02, 8.0, 0.0}, random, scan, walls.get());
      for (std::size_t beam = 0; beam < scan.ranges.size(); beam += 5) {
        const double angle = pose.heading + scan.angle(beam);
        const double expected = walked(*grid, frame, pose, angle, 8.0);
        // A beam may graze a corner between two millimetres.
        if (std::abs(static_cast<double>(scan.ranges[beam]) - expected) > 0.002) ++apart;
      }
    }
    EXPECT_LE(apart, 3) << "of 654 beams, heading " << heading;
  }
}

TEST(Walls, AreAsFarAsTheirNearestCell) {
  const auto grid = building(0.0);
  const Frame frame = *Frame::of(*grid);
  const auto walls = std::make_unique<world::Walls>();
  ASSERT_TRUE(walls->set(*grid));
  world::Random random(6);
  for (int place = 0; place < 40; ++place) {
    const Point2D at = frame.world({random.uniform(0.0, 480.0), random.uniform(0.0, 320.0)});
    if (is_wall(*grid, frame, at)) continue;
    double least = 1e9;
    for (int y = 0; y < grid->height; ++y) {
      for (int x = 0; x < grid->width; ++x) {
        if (grid->cells[frame.index(x, y)] != 100) continue;
        const Point2D cell = frame.cells(at);
        const double dx = cell.x - std::clamp(cell.x, double(x), x + 1.0);
        const double dy = cell.y - std::clamp(cell.y, double(y), y + 1.0);
        least = std::min(least, grid->resolution * std::hypot(dx, dy));
      }
    }

    EXPECT_NEAR(walls->clearance(at), least, 0.03);
  }
  EXPECT_GT(walls->clearance({100.0, 0.0}), 1e6) << "off the map there are none";
}

TEST(Walls, AreSeenBehindDiscsOnlyWhereThereIsNone) {
  const auto walls = std::make_unique<world::Walls>();
  ASSERT_TRUE(walls->set(*building(0.0)));
  world::Map discs;
  discs.add({{3.0, 0.0}, 0.5});
  world::Random random(1);
  LaserScan scan;

  world::cast(discs, {0.0, 0.0, 0.0}, {0.02, 20.0, 0.0}, random, scan, walls.get());

  EXPECT_NEAR(scan.ranges[270], 2.5, 0.01) << "straight ahead stands the disc";
  EXPECT_NEAR(scan.ranges[90], 4.8, 0.01) << "to the right the fence";
}

TEST(Walls, BearWhatIsNoMapAndNoPlace) {
  const auto walls = std::make_unique<world::Walls>();
  EXPECT_FALSE(walls->set(*std::make_unique<OccupancyGrid>()));
  ASSERT_TRUE(walls->set(*building(0.0)));
  world::Random random(1);
  LaserScan scan;
  const double none = std::nan("");

  world::cast({}, {none, 0.0, 0.0}, {}, random, scan, walls.get());
  world::cast({}, {0.0, 0.0, none}, {}, random, scan, walls.get());
  world::cast({}, {1e300, -1e300, 0.0}, {}, random, scan, walls.get());

  EXPECT_EQ(scan.ranges.size(), world::Laser::kBeams);
  EXPECT_GT(walls->clearance({none, none}), 1e6);
}

}  // namespace
