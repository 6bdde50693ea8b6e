// SPDX-License-Identifier: LGPL-3.0-or-later
/// The simulated world: a differential-drive robot with disturbed inputs among discs and walls. No
/// clock, no heap.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "../types/pose.h"
#include "../types/scan.h"
#include "../types/velocity.h"
#include "random.h"

namespace world {

using rover::LaserScan;
using rover::Odometry;
using rover::Point2D;
using rover::Pose2D;
using rover::Velocity;

/// A round obstacle, metres.
struct Disc {
  Point2D at;
  double radius = 0.0;
};

/// The obstacles.
struct Map {
  static constexpr std::size_t kCapacity = 32;

  std::array<Disc, kCapacity> discs{};
  std::size_t size = 0;

  void add(const Disc& disc) {
    if (size < kCapacity) discs[size++] = disc;
  }
  [[nodiscard]] const Disc* begin() const { return discs.data(); }
  [[nodiscard]] const Disc* end() const { return discs.data() + size; }
  /// Distance from the point to the nearest surface, m; large when there is none. [rt]
  [[nodiscard]] double clearance(const Point2D& from) const;
};

/// `count` discs between start and goal with at least `gap` metres between surfaces. [any]
[[nodiscard]] Map random_map(std::uint64_t seed, std::size_t count, double gap,
                             const Point2D& start, const Point2D& goal);

/// Fixed shape of the simulated laser: 270 degrees in half-degree steps.
struct Laser {
  static constexpr std::size_t kBeams = 541;
  double range_min = 0.02;
  double range_max = 8.0;
  double noise = 0.0;  ///< standard deviation of a range, m
};

class Walls;

/// Fills `scan` as a laser at `pose` sees the map; `walls` may be null. [rt]
void cast(const Map& map, const Pose2D& pose, const Laser& laser, Random& random, LaserScan& scan,
          const Walls* walls = nullptr);

/// How much the robot's inputs are disturbed; redrawn every 0.2 s.
struct Disturbance {
  double speed = 0.0;  ///< up to, m/s
  double turn = 0.0;   ///< up to, rad/s
};

/// The robot: its true pose, and its odometry.
class Robot {
 public:
  explicit Robot(std::uint64_t seed, const Pose2D& start = {}) : pose_(start), random_(seed) {
    odometry_.x = start.x;
    odometry_.y = start.y;
    odometry_.heading = start.heading;
  }

  /// Drives for `dt` seconds at the speed commanded, plus the disturbance. [rt]
  void drive(const Velocity& command, const Disturbance& disturbance, double dt);
  [[nodiscard]] const Pose2D& pose() const { return pose_; }
  /// Wheel odometry: measures the disturbed motion with a small scale error. [rt]
  [[nodiscard]] const Odometry& odometry() const { return odometry_; }

 private:
  Pose2D pose_;
  Odometry odometry_;
  Random random_;
  double redraw_in_ = 0.0;
  Velocity push_;
};

}  // namespace world
