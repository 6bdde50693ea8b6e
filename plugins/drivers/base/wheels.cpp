// SPDX-License-Identifier: LGPL-3.0-or-later
#include "wheels.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace drivers {
namespace {

/// Twice as far as the wheels drive by themselves, for a push or a slope, and a margin for delays.
constexpr double kPlausible = 2.0;
constexpr double kMargin = 20.0;  // counts

/// The shorter way round.
int difference(std::uint16_t now, std::uint16_t before) {
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(now - before));
}

}  // namespace

double Wheels::step() const { return std::numbers::pi * diameter / counts; }

WheelSpeeds wheel_speeds(const rover::Velocity& velocity, const Wheels& wheels) {
  const double turn = velocity.angular * wheels.base / 2.0;
  const double left = velocity.linear - turn;
  const double right = velocity.linear + turn;
  if (!std::isfinite(left) || !std::isfinite(right)) return {};
  const double fastest = std::max(std::abs(left), std::abs(right));
  const double share = fastest > wheels.speed_max ? wheels.speed_max / fastest : 1.0;
  return {left * share, right * share};
}

rover::Velocity velocity_of(const WheelSpeeds& speeds, const Wheels& wheels) {
  return {(speeds.left + speeds.right) / 2.0, (speeds.right - speeds.left) / wheels.base};
}

WheelOdometry::Step WheelOdometry::advance(std::uint16_t left, std::uint16_t right, double seconds,
                                           const Wheels& wheels) {
  const int turned_left = difference(left, left_);
  const int turned_right = difference(right, right_);
  const bool first = !begun_;
  left_ = left;
  right_ = right;
  begun_ = true;
  if (first) return Step::first;
  const double most = kPlausible * wheels.speed_max / wheels.step() * seconds + kMargin;
  if (!(seconds > 0.0) || seconds > kLongest || std::abs(turned_left) > most ||
      std::abs(turned_right) > most) {
    recent_ = {};
    span_ = 0.0;
    odometry_.linear = odometry_.angular = 0.0;
    return Step::jump;
  }
  take({turned_left * wheels.step(), turned_right * wheels.step(), seconds}, wheels);
  return Step::moved;
}

void WheelOdometry::take(const Travel& travel, const Wheels& wheels) {
  const rover::Velocity moved = velocity_of({travel.left, travel.right}, wheels);
  const double middle = odometry_.heading + moved.angular / 2.0;
  odometry_.x += moved.linear * std::cos(middle);
  odometry_.y += moved.linear * std::sin(middle);
  odometry_.heading = rover::wrap(odometry_.heading + moved.angular);
  recent_[next_] = travel;
  next_ = (next_ + 1) % kWindow;
  Travel sum;
  for (const Travel& one : recent_) {
    sum.left += one.left;
    sum.right += one.right;
    sum.seconds += one.seconds;
  }
  span_ = sum.seconds;
  const rover::Velocity mean =
      velocity_of({sum.left / sum.seconds, sum.right / sum.seconds}, wheels);
  odometry_.linear = mean.linear;
  odometry_.angular = mean.angular;
}

}  // namespace drivers
