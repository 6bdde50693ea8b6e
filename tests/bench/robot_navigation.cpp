// SPDX-License-Identifier: LGPL-3.0-or-later
/// The planner of plugins/navigation on a million cells: the building of etc/maps drawn with 1000 x
/// 1000, and random goals. The worst goal lies behind walls, so the planner searches all cells. The
/// program also measures the cost of the walls of the simulated world for its laser.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "../../plugins/navigation/map_file.h"
#include "../../plugins/navigation/planner.h"
#include "../../plugins/world/random.h"
#include "../../plugins/world/walls.h"
#include "../../plugins/world/world.h"
#include "bench/robot.h"
#include "bench/support/checked.h"
#include "support/grid_reference.h"

namespace bench {
namespace {

using navigation::Answer;
using navigation::OccupancyGrid;
using navigation::Planner;
using navigation::Point2D;

constexpr int kSide = 1000;
constexpr double kResolution = 0.024;
constexpr navigation::PlannerLimits kLimits{0.45, false};

template <typename F>
double milliseconds(F&& f) {
  const auto start = std::chrono::steady_clock::now();
  f();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

std::unique_ptr<OccupancyGrid> drawn_large(const OccupancyGrid& from) {
  auto grid = std::make_unique<OccupancyGrid>();
  grid->width = grid->height = kSide;
  grid->resolution = kResolution;
  grid->cells.resize(std::size_t{kSide} * kSide);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const int row = y * from.height / kSide;
      const int column = x * from.width / kSide;
      grid->cells[static_cast<std::size_t>(y * kSide + x)] =
          from.cells[static_cast<std::size_t>(row * from.width + column)];
    }
  }
  return grid;
}

/// Free but for a ring round the middle.
std::unique_ptr<OccupancyGrid> with_a_keep() {
  auto grid = std::make_unique<OccupancyGrid>();
  grid->width = grid->height = kSide;
  grid->resolution = kResolution;
  grid->cells.resize(std::size_t{kSide} * kSide);
  for (int i = 0; i < kSide * kSide; ++i) {
    const double radius = std::hypot(i % kSide - kSide / 2, i / kSide - kSide / 2);
    if (radius > 40.0 && radius < 42.0) grid->cells[static_cast<std::size_t>(i)] = 100;
  }
  return grid;
}

Point2D anywhere(world::Random& random) {
  return {random.uniform(0.0, kSide * kResolution), random.uniform(0.0, kSide * kResolution)};
}

/// One turn of the laser in the building, us.
double turn(const world::Walls& walls, const Point2D& at, world::Random& random) {
  rover::LaserScan scan;
  return 1000.0 * milliseconds([&] {
           world::cast({}, {at.x, at.y, 0.0}, {0.02, 8.0, 0.0}, random, scan, &walls);
         });
}

/// The longest of 100 ways, over the optimum of the same grid.
double longest(const OccupancyGrid& grid, Planner& planner, int sources) {
  const support::GridReference reference(grid, kLimits.keep_away);
  world::Random random(7);
  rover::Path path;
  double worst = 0.0;
  for (int source = 0; source < sources; ++source) {
    const Point2D start = reference.random_free(random);
    const auto best = reference.distances_from(start);
    for (int goals = 0; goals < 10;) {
      const Point2D goal = reference.random_free(random);
      const double least = best[reference.frame().index(reference.frame().cells(goal))];
      if (least == 0.0 || least == support::kFarAway) continue;
      must_hold(planner.plan(start, goal, path) == Answer::found, "no way");
      worst = std::max(worst, support::length(start, path) / least);
      ++goals;
    }
  }
  return worst;
}

}  // namespace

void report_navigation(const Options& options) {
  Report report("robot: navigation",
                "A way through 1000 x 1000 cells: A*, and the way points that are left of it.",
                options);
  Figure& take = report.figure("taking over a map", "ms", at_most(50));
  Figure& middle = report.figure("a plan, p50", "ms", at_most(50));
  Figure& high = report.figure("a plan, p90", "ms", at_most(50));
  Figure& most = report.figure("a plan, longest", "ms");
  Figure& none = report.figure("no way, everything searched", "ms");
  Figure& laser = report.figure("541 beams among walls, p90", "us", at_most(1000));
  Figure& detour = report.figure("length of the way over the straight line, p50", "");
  Figure& best =
      report.figure("length of the longest of 100 ways over the grid's optimum", "", at_most(1.05));
  const auto small = std::make_unique<OccupancyGrid>();
  must(navigation::load_map(MAUVE_SOURCE_DIR "/etc/maps/building.yaml", *small));
  const auto large = drawn_large(*small);
  const auto keep = with_a_keep();
  const auto walls = std::make_unique<world::Walls>();
  must_hold(walls->set(*small), "no walls");
  const auto planner = std::make_unique<Planner>(1024UL * 1024UL);
  const auto path = std::make_unique<rover::Path>();
  world::Random random(1);
  for (int round = 0; round < options.rounds; ++round) {
    take.add(milliseconds([&] { must_hold(planner->set_map(*large, kLimits), "no map"); }));
    std::vector<double> times;
    std::vector<double> ratios;
    for (const int plans = options.choose(200, 10); static_cast<int>(times.size()) < plans;) {
      const Point2D start = anywhere(random);
      const Point2D goal = anywhere(random);
      Answer answer = Answer::no_way;
      const double time = milliseconds([&] { answer = planner->plan(start, goal, *path); });
      if (answer != Answer::found) continue;
      times.push_back(time);
      ratios.push_back(support::length(start, *path) /
                       std::hypot(goal.x - start.x, goal.y - start.y));
    }
    middle.add(median(times));
    high.add(percentile(times, 90));
    most.add(percentile(times, 100));
    detour.add(median(ratios));
    std::vector<double> turns;
    for (int i = 0; i < options.choose(1000, 10); ++i) {
      const Point2D at{random.uniform(-4.0, 20.0), random.uniform(-5.0, 11.0)};
      turns.push_back(turn(*walls, at, random));
    }
    laser.add(percentile(turns, 90));
    if (round == 0) best.add(longest(*large, *planner, options.choose(10, 1)));
    must_hold(planner->set_map(*keep, kLimits), "no map");
    none.add(milliseconds([&] {
      must_hold(planner->plan({1.0, 1.0}, {12.0, 12.0}, *path) == Answer::no_way, "a way");
    }));
  }
  report.print();
}

}  // namespace bench
