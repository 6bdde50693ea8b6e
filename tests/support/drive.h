// SPDX-License-Identifier: LGPL-3.0-or-later
/// A robot that is driven by a guidance law through a simulated world, without mauve: scans at 40
/// Hz, law and pilot at 100 Hz, as in etc/rover.json.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "../../plugins/guidance/avoidance.h"
#include "../../plugins/guidance/field.h"
#include "../../plugins/guidance/gap.h"
#include "../../plugins/guidance/guidance.h"
#include "../../plugins/guidance/obstacles.h"
#include "../../plugins/safety/zones.h"
#include "../../plugins/world/walls.h"
#include "../../plugins/world/world.h"

namespace support::drive {

using guidance::Guidance;
using rover::LaserScan;
using rover::Point2D;
using rover::Pose2D;
using rover::Velocity;

constexpr double kStep = 0.01;      // s, the pace of the control loop
constexpr double kArrived = 0.15;   // m
constexpr double kTouching = 0.35;  // m from the robot's centre to a surface
constexpr double kNever = std::numeric_limits<double>::infinity();

/// The command given at this pose, within its slew limits.
using Driver = std::function<Velocity(const Pose2D&, const LaserScan&, Guidance& state)>;
/// The command wanted, before slew limits.
using Law = std::function<Velocity(const Pose2D&, const LaserScan&, const guidance::Obstacles&,
                                   Guidance& state)>;

inline Law field(const guidance::FieldParameters& parameters = {}) {
  return [p = guidance::repaired(parameters)](
             const Pose2D& pose, const LaserScan&, const guidance::Obstacles& obstacles,
             Guidance& state) { return guidance::follow_field(p, pose, obstacles, state); };
}

inline Law finite_time(const guidance::AvoidanceParameters& parameters = {}) {
  return [parameters](const Pose2D& pose, const LaserScan&, const guidance::Obstacles& obstacles,
                      Guidance& state) {
    return guidance::avoid(parameters, pose, obstacles, kStep, state);
  };
}

inline Law widest_gap(const guidance::GapParameters& parameters = {}) {
  return
      [parameters](const Pose2D& pose, const LaserScan& scan, const guidance::Obstacles&,
                   Guidance& state) { return guidance::follow_gap(parameters, pose, scan, state); };
}

/// The steps of guidance/control before and after a law.
inline Driver driven_by(Law law) {
  return [law = std::move(law), obstacles = guidance::Obstacles()](
             const Pose2D& pose, const LaserScan& scan, Guidance& state) mutable {
    constexpr double kHorizon = 3.0;
    guidance::nearest_points(scan, pose, kHorizon, obstacles);
    const Velocity wanted = law(pose, scan, obstacles, state);
    return guidance::slewed(state.command, wanted, guidance::SlewLimits{}, kStep);
  };
}

struct World {
  world::Map map;
  const world::Walls* walls = nullptr;

  [[nodiscard]] double clearance(const Pose2D& pose) const {
    const double discs = map.clearance({pose.x, pose.y});
    return walls == nullptr ? discs : std::min(discs, walls->clearance({pose.x, pose.y}));
  }
};

/// The conditions that are the same for all drives of a table.
struct Conditions {
  world::Disturbance disturbance{0.1, 0.5};
  double laser_noise = 0.0;               ///< m
  const safety::Limits* pilot = nullptr;  ///< null: none
  double limit = 120.0;                   ///< s, then a drive has failed
  bool draws = false;                     ///< keeps the track
};

struct Outcome {
  bool reached = false;
  double seconds = 0.0;
  double length = 0.0;        ///< m driven
  double clearance = kNever;  ///< m, least, from the robot's centre
  double jump = 0.0;  ///< largest change of the command in a step, as share of its slew limit
  std::vector<Point2D> track;
};

/// The change from one command to the next, as share of the allowed change.
inline double jump(const Velocity& last, const Velocity& next) {
  constexpr guidance::SlewLimits kLimits;
  const bool slower = std::abs(next.linear) < std::abs(last.linear);
  const double speed_step = (slower ? kLimits.slow_down : kLimits.speed_up) * kStep;
  return std::max(std::abs(next.linear - last.linear) / speed_step,
                  std::abs(next.angular - last.angular) / (kLimits.turn * kStep));
}

/// One robot on its way; a test with a planner moves `state.goal`.
class Drive {
 public:
  Drive(const World& world, const Conditions& conditions, const Pose2D& start, std::uint64_t seed)
      : world_(world), conditions_(conditions), robot_(seed, start), random_(seed) {
    state.dwell = 1e3;
  }

  Guidance state;

  [[nodiscard]] const Pose2D& pose() const { return robot_.pose(); }
  [[nodiscard]] const LaserScan& scan() const { return scan_; }
  [[nodiscard]] Outcome& outcome() { return outcome_; }
  [[nodiscard]] bool over() const { return outcome_.seconds >= conditions_.limit; }
  /// A scan when it is time for one.
  void look() {
    constexpr int kScanEvery[] = {1, 0, 0, 1, 0};  // two in five steps
    if (kScanEvery[step_ % 5] == 0) return;
    world::cast(world_.map, pose(), {0.02, 8.0, conditions_.laser_noise}, random_, scan_,
                world_.walls);
  }
  void go(const Velocity& command) {
    outcome_.jump = std::max(outcome_.jump, jump(state.command, command));
    state.command = command;
    const Pose2D before = pose();
    robot_.drive(passed(command), conditions_.disturbance, kStep);
    outcome_.length += std::hypot(pose().x - before.x, pose().y - before.y);
    outcome_.clearance = std::min(outcome_.clearance, world_.clearance(pose()));
    outcome_.seconds += kStep;
    if (conditions_.draws && step_ % 10 == 0) outcome_.track.push_back({pose().x, pose().y});
    ++step_;
  }

 private:
  Velocity passed(const Velocity& command) {
    if (conditions_.pilot == nullptr) return command;
    const double way = safety::free_way(scan_, conditions_.pilot->half_width);
    zone_ = safety::next_zone(zone_, way, *conditions_.pilot);
    return safety::limited(command, zone_);
  }

  const World& world_;
  const Conditions& conditions_;
  world::Robot robot_;
  world::Random random_;
  LaserScan scan_;
  safety::Zone zone_ = safety::Zone::clear;
  Outcome outcome_;
  int step_ = 0;
};

/// From the origin to the goal.
inline Outcome drive(const Driver& driver, const World& world, const Point2D& goal,
                     std::uint64_t seed, const Conditions& conditions) {
  Drive drive(world, conditions, {}, seed);
  drive.state.goal = goal;
  while (!drive.over()) {
    if (rover::distance(drive.pose(), goal) < kArrived) {
      drive.outcome().reached = true;
      break;
    }
    drive.look();
    drive.go(driver(drive.pose(), drive.scan(), drive.state));
  }
  return std::move(drive.outcome());
}

/// Random worlds: how many discs, how far between their surfaces at least, how far to the goal.
struct Worlds {
  const char* name;
  std::size_t discs;
  bool fewer;  ///< or up to so many
  double gap;
  double length;

  [[nodiscard]] Point2D goal() const { return {length, 0.0}; }
  [[nodiscard]] World world(std::uint64_t seed) const {
    const std::size_t count = fewer ? seed % (discs + 1) : discs;
    return {world::random_map(seed, count, gap, {}, goal())};
  }
};
/// As in the works cited in guidance/field.h and avoidance.h, and two that are harder.
constexpr Worlds kOpen{"open", 6, true, 2.1, 10.0};
constexpr Worlds kDense{"gaps of 1.6 m", 14, false, 1.6, 7.0};
constexpr Worlds kDenser{"gaps of 1.3 m", 14, false, 1.3, 7.0};

struct Summary {
  int reached = 0;
  int touched = 0;
  double jump = 0.0;
  std::vector<double> clearances;
  std::vector<double> seconds;  ///< of those that arrived, as the next
  std::vector<double> lengths;

  void add(const Outcome& run) {
    touched += run.clearance < kTouching ? 1 : 0;
    jump = std::max(jump, run.jump);
    clearances.push_back(run.clearance);
    if (!run.reached) return;
    ++reached;
    seconds.push_back(run.seconds);
    lengths.push_back(run.length);
  }
  [[nodiscard]] double least_clearance() const {
    return clearances.empty() ? kNever : *std::min_element(clearances.begin(), clearances.end());
  }
};

inline double mean(const std::vector<double>& samples) {
  return samples.empty() ? 0.0
                         : std::accumulate(samples.begin(), samples.end(), 0.0) /
                               static_cast<double>(samples.size());
}

/// The first `count` of these worlds.
inline Summary drive_worlds(const Driver& driver, const Worlds& worlds, int count,
                            const Conditions& conditions = {}) {
  Summary sum;
  for (std::uint64_t seed = 1; seed <= static_cast<std::uint64_t>(count); ++seed) {
    sum.add(drive(driver, worlds.world(seed), worlds.goal(), seed, conditions));
  }
  return sum;
}

}  // namespace support::drive
