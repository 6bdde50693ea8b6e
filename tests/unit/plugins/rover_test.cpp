// SPDX-License-Identifier: LGPL-3.0-or-later
/// The rover of etc/yard.json, without mauve around it: does it arrive, whatever core drives it?
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include "../../../plugins/guidance/avoidance.h"
#include "../../../plugins/guidance/field.h"
#include "../../../plugins/guidance/gap.h"
#include "../../../plugins/safety/zones.h"
#include "../../../plugins/world/world.h"

namespace {

using guidance::Guidance;
using guidance::Obstacles;
using rover::LaserScan;
using rover::Pose2D;
using rover::Velocity;

struct Rover {
  world::Map map;
  rover::Point2D goal;
  safety::Limits limits;
};

Rover rover_of_the_example() {
  std::ifstream file(std::filesystem::path(MAUVE_SOURCE_DIR) / "etc" / "yard.json");
  const auto json = nlohmann::json::parse(file, nullptr, true, true);
  Rover rover;
  for (const auto& disc : json["resources"]["world"]["properties"]["core.obstacles"]) {
    rover.map.add({{disc["at"]["x"], disc["at"]["y"]}, disc["radius"]});
  }
  const auto& components = json["components"];
  const auto& goal = components["mission"]["properties"]["core.goal"];
  rover.goal = {goal["x"], goal["y"]};
  const auto& pilot = components["safety"]["properties"];
  rover.limits.stop_distance = pilot["core.stop_distance"];
  rover.limits.slow_distance = pilot["core.slow_distance"];
  return rover;
}

/// One of the three cores; `progress` is the share of the way that is done.
using Choice = std::function<int(double progress)>;

struct Drive {
  double seconds = 0.0;
  double clearance = 1e9;
};

Velocity steer(int core, const Pose2D& pose, const LaserScan& scan, Guidance& state) {
  static const guidance::FieldParameters field = guidance::repaired({});
  Obstacles obstacles;
  guidance::nearest_points(scan, pose, 3.0, obstacles);
  if (core == 0) return guidance::follow_field(field, pose, obstacles, state);
  if (core == 1) return guidance::avoid({}, pose, obstacles, 0.01, state);
  return guidance::follow_gap({}, pose, scan, state);
}

Drive drive(const Rover& rover, std::uint64_t seed, const Choice& choose) {
  world::Robot robot(seed);
  world::Random random(seed + 1);
  Guidance state;
  state.goal = rover.goal;
  state.dwell = 10.0;
  LaserScan scan;
  Drive driven;
  safety::Zone zone = safety::Zone::clear;
  const double whole = rover::distance({}, rover.goal);
  for (int step = 0; driven.seconds < 120.0; ++step, driven.seconds += 0.01) {
    const auto& odometry = robot.odometry();
    const Pose2D pose{odometry.x, odometry.y, odometry.heading};
    if (rover::distance(pose, rover.goal) < 0.15) break;
    if (step % 3 == 0) world::cast(rover.map, robot.pose(), {0.02, 8.0, 0.01}, random, scan);
    const int core = choose(1.0 - rover::distance(pose, rover.goal) / whole);
    state.command = guidance::slewed(state.command, steer(core, pose, scan, state), {}, 0.01);
    zone = safety::next_zone(zone, safety::free_way(scan, rover.limits.half_width), rover.limits);
    robot.drive(safety::limited(state.command, zone), {0.05, 0.25}, 0.01);
    driven.clearance =
        std::min(driven.clearance, rover.map.clearance({robot.pose().x, robot.pose().y}));
  }
  return driven;
}

void expect_arrives(const Choice& choose, const char* name) {
  const Rover rover = rover_of_the_example();
  double slowest = 0.0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Drive driven = drive(rover, seed, choose);
    EXPECT_LT(driven.seconds, 45.0) << name << ", seed " << seed;
    EXPECT_GT(driven.clearance, 0.35) << name << ", seed " << seed;
    slowest = std::max(slowest, driven.seconds);
  }
  testing::Test::RecordProperty("slowest_seconds", std::to_string(slowest));
}

TEST(Rover, ArrivesWithThePotentialField) {
  expect_arrives([](double) { return 0; }, "potential_field");
}

TEST(Rover, ArrivesWithFiniteTimeAvoidance) {
  expect_arrives([](double) { return 1; }, "finite_time");
}

TEST(Rover, ArrivesWithTheWidestGap) {
  expect_arrives([](double) { return 2; }, "widest_gap");
}

TEST(Rover, ArrivesThroughTheSwapsOfTheDemo) {
  expect_arrives([](double done) { return done < 0.4 ? 0 : done < 0.7 ? 1 : 2; }, "all three");
}

}  // namespace
