// SPDX-License-Identifier: LGPL-3.0-or-later
/// Drives through the building of etc/maps: the core of navigation/navigation gives one target
/// after the other, a guidance law drives there, the pilot watches.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <mauve/test_kit.h>

#include "../../plugins/navigation/map_file.h"
#include "../../plugins/navigation/navigation.h"
#include "../../plugins/world/random.h"
#include "support/drive.h"
#include "support/grid_reference.h"

namespace support::building {

using drive::Point2D;
using navigation::OccupancyGrid;

/// Of etc/rover.json.
constexpr double kDoorObstacle = 0.55;  // m, obstacle_distance
constexpr double kDoorSafety = 0.4;     // m, safety_distance
constexpr double kSpeed = 0.45;         // m/s
constexpr double kKeepAway = 0.55;      // m, of the planner
constexpr safety::Limits kPilot{0.4, 0.8, 0.3, 0.1};
/// Noise and disturbance as in drivers/world, whose defaults the building uses.
inline drive::Conditions conditions() { return {{0.05, 0.25}, 0.01, &kPilot, 240.0, false}; }

inline drive::Law field() {
  guidance::FieldParameters p;
  p.obstacle_distance = kDoorObstacle;
  p.safety_distance = kDoorSafety;
  p.speed = kSpeed;
  return drive::field(p);
}
inline drive::Law finite_time() {
  guidance::AvoidanceParameters p;
  p.obstacle_distance = kDoorObstacle;
  p.safety_distance = kDoorSafety;
  p.speed = kSpeed;
  return drive::finite_time(p);
}

/// From one place to another.
struct Errand {
  Point2D from;
  Point2D to;
  double heading;
  double length;  ///< m, of the way planned
};

class Building {
 public:
  /// False when there is no such map.
  [[nodiscard]] bool load(const std::string& root) {
    const auto file = std::filesystem::path(root) / "etc/maps/building.yaml";
    grid_->time = 1.0;
    return static_cast<bool>(navigation::load_map(file.string(), *grid_)) && walls_->set(*grid_) &&
           planner_->set_map(*grid_, {kKeepAway, false});
  }

  [[nodiscard]] const OccupancyGrid& grid() const { return *grid_; }
  [[nodiscard]] const world::Walls& walls() const { return *walls_; }

  /// Between places that do not see each other, 8 m or more apart by the way.
  [[nodiscard]] Errand errand(world::Random& random) const {
    rover::Path path;
    while (true) {
      const Point2D from = anywhere(random);
      const Point2D to = anywhere(random);
      const bool hidden = !planner_->free(from, to);
      if (!hidden || planner_->plan(from, to, path) != navigation::Answer::found) continue;
      const double way = length(from, path);
      const double heading = random.uniform(-std::numbers::pi, std::numbers::pi);
      if (way >= 8.0) return {from, to, heading, way};
    }
  }

  [[nodiscard]] drive::Outcome drive(const drive::Driver& driver, const Errand& errand,
                                     std::uint64_t seed, drive::Conditions conditions) const;

 private:
  [[nodiscard]] Point2D anywhere(world::Random& random) const {
    constexpr double kRoom = 0.6;  // m, to start and end in
    while (true) {
      const Point2D at{random.uniform(-4.0, 20.0), random.uniform(-5.0, 11.0)};
      if (planner_->clearance(at) >= kRoom) return at;
    }
  }

  std::unique_ptr<OccupancyGrid> grid_ = std::make_unique<OccupancyGrid>();
  std::unique_ptr<world::Walls> walls_ = std::make_unique<world::Walls>();
  std::unique_ptr<navigation::Planner> planner_ =
      std::make_unique<navigation::Planner>(1024UL * 1024UL);
};

/// The state machine of navigation/navigation, on the way.
class Pilotage {
 public:
  Pilotage(const OccupancyGrid& grid, const Point2D& goal) {
    static_cast<void>(bench_.core().find_property("keep_away")->set(mauve::Value(kKeepAway)));
    if (!bench_.configure()) return;
    bench_.give(bench_.shell().map, grid);
    bench_.give(bench_.shell().goal, goal);
  }

  /// Every 200 ms; true on arrival.
  bool look(const rover::Pose2D& pose, const rover::LaserScan& scan) {
    bench_.give(bench_.shell().pose, pose);
    bench_.give(bench_.shell().scan, scan);
    bench_.advance(std::chrono::milliseconds(200));
    auto& core = bench_.core();
    if (!core.has_goal() || core.no_way()) {
      core.poll_goal();
      if (core.has_goal()) core.make_plan();
      if (core.no_way()) core.stand();
      return false;
    }
    core.follow();
    if (!core.arrived() && core.must_plan()) core.make_plan();
    if (core.no_way()) core.stand();
    return core.arrived();
  }
  [[nodiscard]] std::optional<Point2D> target() { return bench_.written(bench_.shell().target); }
  [[nodiscard]] std::int64_t observe(const char* name) {
    return *bench_.core().find_observable(name)->value().get_if<std::int64_t>();
  }

 private:
  mauve::CoreBench<navigation::NavigationShell, navigation::Navigation> bench_;
};

inline drive::Outcome Building::drive(const drive::Driver& driver, const Errand& errand,
                                      std::uint64_t seed, drive::Conditions conditions) const {
  const drive::World world{{}, walls_.get()};
  drive::Drive drive(world, conditions, {errand.from.x, errand.from.y, errand.heading}, seed);
  const auto way = std::make_unique<Pilotage>(*grid_, errand.to);
  for (int step = 0; !drive.over(); ++step) {
    drive.look();
    if (step % 20 == 0) {
      drive.outcome().reached = way->look(drive.pose(), drive.scan());
      if (drive.outcome().reached) break;
      guidance::aim_at(way->target().value_or(drive.state.goal), drive.state);
    }
    drive.go(driver(drive.pose(), drive.scan(), drive.state));
  }
  return std::move(drive.outcome());
}

}  // namespace support::building
