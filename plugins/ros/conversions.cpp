// SPDX-License-Identifier: LGPL-3.0-or-later
#include "conversions.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace ros_bridge {
namespace {

template <typename... N>
bool finite(N... numbers) {
  return (std::isfinite(numbers) && ...);
}

/// rotation about z
template <typename Quaternion>
void to_quaternion(double heading, Quaternion& q) {
  q.x = 0.0;
  q.y = 0.0;
  q.z = std::sin(heading / 2.0);
  q.w = std::cos(heading / 2.0);
}

/// Of any rotation, also one that is not normalised; 0 for one of zeros, which people send.
template <typename Quaternion>
double heading_of(const Quaternion& q) {
  const double squares = q.w * q.w + q.x * q.x - q.y * q.y - q.z * q.z;
  return std::atan2(2.0 * (q.w * q.z + q.x * q.y), squares);
}

template <typename Message>
void to_pose(const rover::Pose2D& pose, Message& message) {
  message.position.x = pose.x;
  message.position.y = pose.y;
  message.position.z = 0.0;
  to_quaternion(pose.heading, message.orientation);
}

template <typename Message>
bool from_pose(const Message& message, rover::Pose2D& pose) {
  pose = {message.position.x, message.position.y, heading_of(message.orientation)};
  return finite(pose.x, pose.y, pose.heading);
}

}  // namespace

void RosMessage<rover::Joystick>::to(const rover::Joystick& joystick, Type& message) {
  message.axes.assign(joystick.axes.begin(), joystick.axes.end());
  message.buttons.resize(32);
  const auto bits = static_cast<std::uint32_t>(joystick.buttons);
  for (std::size_t i = 0; i < 32; ++i) {
    message.buttons[i] = static_cast<std::int32_t>((bits >> i) & 1U);
  }
}

bool RosMessage<rover::Joystick>::from(const Type& message, rover::Joystick& joystick) {
  joystick.axes.clear();
  for (const float axis : message.axes) {
    joystick.axes.push_back(std::isnan(axis) ? 0.0F : std::clamp(axis, -1.0F, 1.0F));
  }
  std::uint32_t bits = 0;
  for (std::size_t i = 0; i < std::min<std::size_t>(message.buttons.size(), 32); ++i) {
    if (message.buttons[i] != 0) bits |= 1U << i;
  }
  joystick.buttons = static_cast<std::int32_t>(bits);
  joystick.connected = true;
  return true;
}

void RosMessage<rover::Point2D>::to(const rover::Point2D& goal, Type& message) {
  to_pose({goal.x, goal.y, 0.0}, message.pose);
}

bool RosMessage<rover::Point2D>::from(const Type& message, rover::Point2D& goal) {
  goal = {message.pose.position.x, message.pose.position.y};
  return finite(goal.x, goal.y);
}

void RosMessage<rover::Velocity>::to(const rover::Velocity& velocity, Type& message) {
  message.linear.x = velocity.linear;
  message.angular.z = velocity.angular;
}

bool RosMessage<rover::Velocity>::from(const Type& message, rover::Velocity& velocity) {
  velocity = {message.linear.x, message.angular.z};
  return finite(velocity.linear, velocity.angular);
}

void RosMessage<rover::LaserScan>::to(const rover::LaserScan& scan, Type& message) {
  message.angle_min = scan.angle_min;
  message.angle_increment = scan.angle_increment;
  message.angle_max =
      scan.ranges.empty() ? scan.angle_min : static_cast<float>(scan.angle(scan.ranges.size() - 1));
  message.range_min = scan.range_min;
  message.range_max = scan.range_max;
  message.ranges.assign(scan.ranges.begin(), scan.ranges.end());
}

bool RosMessage<rover::LaserScan>::from(const Type& message, rover::LaserScan& scan) {
  if (message.ranges.size() > scan.ranges.capacity() ||
      !finite(message.angle_min, message.angle_increment, message.range_min, message.range_max)) {
    return false;
  }
  scan.angle_min = message.angle_min;
  scan.angle_increment = message.angle_increment;
  scan.range_min = message.range_min;
  scan.range_max = message.range_max;
  scan.ranges.resize(message.ranges.size());
  std::copy(message.ranges.begin(), message.ranges.end(), scan.ranges.begin());
  return true;
}

void RosMessage<rover::Odometry>::to(const rover::Odometry& odometry, Type& message) {
  message.child_frame_id = "base_link";
  to_pose({odometry.x, odometry.y, odometry.heading}, message.pose.pose);
  message.twist.twist.linear.x = odometry.linear;
  message.twist.twist.angular.z = odometry.angular;
}

bool RosMessage<rover::Odometry>::from(const Type& message, rover::Odometry& odometry) {
  rover::Pose2D pose;
  const bool placed = from_pose(message.pose.pose, pose);
  odometry.x = pose.x;
  odometry.y = pose.y;
  odometry.heading = pose.heading;
  odometry.linear = message.twist.twist.linear.x;
  odometry.angular = message.twist.twist.angular.z;
  return placed && finite(odometry.linear, odometry.angular);
}

void RosMessage<rover::Pose2D>::to(const rover::Pose2D& pose, Type& message) {
  to_pose(pose, message.pose);
}

bool RosMessage<rover::Pose2D>::from(const Type& message, rover::Pose2D& pose) {
  return from_pose(message.pose, pose);
}

void RosMessage<rover::Imu>::to(const rover::Imu& imu, Type& message) {
  to_quaternion(imu.has_heading ? imu.heading : 0.0, message.orientation);
  message.orientation_covariance[0] = imu.has_heading ? 0.0 : -1.0;
  message.angular_velocity.z = imu.yaw_rate;
  message.linear_acceleration.x = imu.acceleration_x;
  message.linear_acceleration.y = imu.acceleration_y;
}

bool RosMessage<rover::Imu>::from(const Type& message, rover::Imu& imu) {
  const auto& q = message.orientation;
  const double size = q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w;
  imu.yaw_rate = message.angular_velocity.z;
  imu.acceleration_x = message.linear_acceleration.x;
  imu.acceleration_y = message.linear_acceleration.y;
  imu.has_heading = message.orientation_covariance[0] >= 0.0 && std::abs(size - 1.0) < 0.01;
  imu.heading = imu.has_heading ? heading_of(q) : 0.0;
  return finite(imu.yaw_rate, imu.acceleration_x, imu.acceleration_y);
}

void RosMessage<rover::OccupancyGrid>::to(const rover::OccupancyGrid& grid, Type& message) {
  message.info.resolution = static_cast<float>(grid.resolution);
  message.info.width = static_cast<std::uint32_t>(std::max(grid.width, 0));
  message.info.height = static_cast<std::uint32_t>(std::max(grid.height, 0));
  to_pose(grid.origin, message.info.origin);
  message.data.assign(grid.cells.begin(), grid.cells.end());
}

bool RosMessage<rover::OccupancyGrid>::from(const Type& message, rover::OccupancyGrid& grid) {
  const std::uint64_t width = message.info.width;
  const std::uint64_t height = message.info.height;
  constexpr std::uint64_t kMost = rover::OccupancyGrid::kCapacity;
  if (width == 0 || height == 0 || width > kMost || height > kMost / width ||
      message.data.size() != width * height) {
    return false;
  }
  grid.resolution = static_cast<double>(message.info.resolution);
  if (!finite(grid.resolution) || grid.resolution <= 0.0) return false;
  if (!from_pose(message.info.origin, grid.origin)) return false;
  grid.width = static_cast<std::int32_t>(width);
  grid.height = static_cast<std::int32_t>(height);
  grid.cells.resize(message.data.size());
  std::transform(
      message.data.begin(), message.data.end(), grid.cells.begin(),
      [](std::int8_t cell) { return cell >= 0 && cell <= 100 ? cell : std::int8_t{-1}; });
  return true;
}

}  // namespace ros_bridge
