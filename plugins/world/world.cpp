// SPDX-License-Identifier: LGPL-3.0-or-later
#include "world.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "walls.h"

namespace world {
namespace {

constexpr double kField = 1.5 * std::numbers::pi;  // 270 degrees
constexpr double kStep = kField / static_cast<double>(Laser::kBeams - 1);
constexpr double kRedraw = 0.2;        // s between two draws of the disturbance
constexpr double kWheelScale = 1.002;  // the odometry believes its wheels a little larger
constexpr int kAttempts = 2000;        // to place one disc; then the map has fewer

/// Fills the beams that meet the disc, seen at (x, y) in the laser's frame.
void cast_disc(double x, double y, double radius, LaserScan& scan) {
  const double range = std::hypot(x, y);
  if (range - radius >= static_cast<double>(scan.range_max)) return;
  const double half = range <= radius ? std::numbers::pi : std::asin(radius / range);
  const double middle = std::atan2(y, x) + kField / 2.0;
  const auto last = static_cast<double>(Laser::kBeams - 1);
  const auto from = static_cast<std::size_t>(std::clamp((middle - half) / kStep, 0.0, last));
  const auto to = static_cast<std::size_t>(std::clamp((middle + half) / kStep + 1.0, 0.0, last));
  for (std::size_t beam = from; beam <= to; ++beam) {
    const double angle = scan.angle(beam);
    const double along = x * std::cos(angle) + y * std::sin(angle);
    const double square = along * along - (x * x + y * y - radius * radius);
    if (square < 0.0) continue;
    const double hit = along - std::sqrt(square);
    if (hit > 0.0) scan.ranges[beam] = std::min(scan.ranges[beam], static_cast<float>(hit));
  }
}

bool fits(const Map& map, const Disc& disc, double gap, const Point2D& start, const Point2D& goal) {
  const auto far = [&](const Point2D& point, double least) {
    return std::hypot(point.x - disc.at.x, point.y - disc.at.y) - disc.radius >= least;
  };
  return far(start, 1.2) && far(goal, 1.2) &&
         std::all_of(map.begin(), map.end(),
                     [&](const Disc& other) { return far(other.at, gap + other.radius); });
}

}  // namespace

double Map::clearance(const Point2D& from) const {
  double least = 1e9;
  for (const Disc& disc : *this) {
    least = std::min(least, std::hypot(disc.at.x - from.x, disc.at.y - from.y) - disc.radius);
  }
  return least;
}

Map random_map(std::uint64_t seed, std::size_t count, double gap, const Point2D& start,
               const Point2D& goal) {
  Random random(seed);
  Map map;
  const double length = std::hypot(goal.x - start.x, goal.y - start.y);
  const double cosine = (goal.x - start.x) / length;
  const double sine = (goal.y - start.y) / length;
  for (int attempt = 0; attempt < kAttempts && map.size < count; ++attempt) {
    const double along = random.uniform(0.0, length);
    const double aside = random.uniform(-length / 3.0, length / 3.0);
    const Disc disc{
        {start.x + along * cosine - aside * sine, start.y + along * sine + aside * cosine},
        random.uniform(0.2, 0.6)};
    if (fits(map, disc, gap, start, goal)) map.add(disc);
  }
  return map;
}

void cast(const Map& map, const Pose2D& pose, const Laser& laser, Random& random, LaserScan& scan,
          const Walls* walls) {
  scan.angle_min = static_cast<float>(-kField / 2.0);
  scan.angle_increment = static_cast<float>(kStep);
  scan.range_min = static_cast<float>(laser.range_min);
  scan.range_max = static_cast<float>(laser.range_max);
  scan.ranges.resize(Laser::kBeams);
  std::fill_n(scan.ranges.begin(), Laser::kBeams, scan.range_max);
  const double cosine = std::cos(pose.heading);
  const double sine = std::sin(pose.heading);
  for (const Disc& disc : map) {
    const double dx = disc.at.x - pose.x;
    const double dy = disc.at.y - pose.y;
    cast_disc(cosine * dx + sine * dy, cosine * dy - sine * dx, disc.radius, scan);
  }
  if (walls != nullptr) walls->cast(pose, scan);
  if (laser.noise <= 0.0) return;
  for (std::size_t beam = 0; beam < Laser::kBeams; ++beam) {
    if (scan.valid(beam)) scan.ranges[beam] += static_cast<float>(random.normal(laser.noise));
  }
}

void Robot::drive(const Velocity& command, const Disturbance& disturbance, double dt) {
  redraw_in_ -= dt;
  if (redraw_in_ <= 0.0) {
    push_ = {random_.uniform(-disturbance.speed, disturbance.speed),
             random_.uniform(-disturbance.turn, disturbance.turn)};
    redraw_in_ += kRedraw;
  }
  // The disturbance stands for effects on a moving robot that a model leaves out: a standing one
  // has brakes.
  const bool stands = command.linear == 0.0 && command.angular == 0.0;
  const double speed = stands ? 0.0 : command.linear + push_.linear;
  const double turn = stands ? 0.0 : command.angular + push_.angular;
  const auto advance = [dt](double v, double w, auto& at) {
    const double middle = at.heading + w * dt / 2.0;
    at.x += v * dt * std::cos(middle);
    at.y += v * dt * std::sin(middle);
    at.heading = rover::wrap(at.heading + w * dt);
  };
  advance(speed, turn, pose_);
  advance(speed * kWheelScale, turn, odometry_);
  odometry_.time += dt;
  odometry_.linear = speed;
  odometry_.angular = turn;
}

}  // namespace world
