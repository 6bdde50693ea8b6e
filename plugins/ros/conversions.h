// SPDX-License-Identifier: LGPL-3.0-or-later
/// Each type of the robot and its message of ROS 1, declared once: RosMessage<T>.
#pragma once

#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/Twist.h>
#include <nav_msgs/OccupancyGrid.h>
#include <nav_msgs/Odometry.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/Joy.h>
#include <sensor_msgs/LaserScan.h>

#include <memory>

#include "../types/grid.h"
#include "../types/imu.h"
#include "../types/joystick.h"
#include "../types/pose.h"
#include "../types/scan.h"
#include "../types/velocity.h"

namespace ros_bridge {

/// std::allocator as it was before C++20: the messages ask for its `rebind`.
template <typename T>
struct Heap : std::allocator<T> {
  template <typename U>
  struct rebind {
    using other = Heap<U>;
  };
  Heap() = default;
  template <typename U>
  Heap(const Heap<U>& /*other*/) {}
};

/// Specialised below: the message, and both ways. `from` leaves `time` to its caller; false:
/// refused, the value may be half written. `kDepth` values may wait for the ROS thread; `kLatched`
/// topics show their last value to later subscribers.
template <typename T>
struct RosMessage;

template <>
struct RosMessage<rover::Joystick> {
  using Type = sensor_msgs::Joy_<Heap<void>>;
  static constexpr std::size_t kDepth = 64;
  static constexpr bool kLatched = false;
  static void to(const rover::Joystick& joystick, Type& message);
  static bool from(const Type& message, rover::Joystick& joystick);
};

/// Where to go; the direction there is of no interest.
template <>
struct RosMessage<rover::Point2D> {
  using Type = geometry_msgs::PoseStamped_<Heap<void>>;
  static constexpr std::size_t kDepth = 16;
  static constexpr bool kLatched = true;
  static void to(const rover::Point2D& goal, Type& message);
  static bool from(const Type& message, rover::Point2D& goal);
};

template <>
struct RosMessage<rover::Velocity> {
  using Type = geometry_msgs::Twist_<Heap<void>>;
  static constexpr std::size_t kDepth = 64;
  static constexpr bool kLatched = false;
  static void to(const rover::Velocity& velocity, Type& message);
  static bool from(const Type& message, rover::Velocity& velocity);
};

/// More beams than a LaserScan holds are refused.
template <>
struct RosMessage<rover::LaserScan> {
  using Type = sensor_msgs::LaserScan_<Heap<void>>;
  static constexpr std::size_t kDepth = 16;
  static constexpr bool kLatched = false;
  static void to(const rover::LaserScan& scan, Type& message);
  static bool from(const Type& message, rover::LaserScan& scan);
};

template <>
struct RosMessage<rover::Odometry> {
  using Type = nav_msgs::Odometry_<Heap<void>>;
  static constexpr std::size_t kDepth = 64;
  static constexpr bool kLatched = false;
  static void to(const rover::Odometry& odometry, Type& message);
  static bool from(const Type& message, rover::Odometry& odometry);
};

template <>
struct RosMessage<rover::Pose2D> {
  using Type = geometry_msgs::PoseStamped_<Heap<void>>;
  static constexpr std::size_t kDepth = 64;
  static constexpr bool kLatched = false;
  static void to(const rover::Pose2D& pose, Type& message);
  static bool from(const Type& message, rover::Pose2D& pose);
};

/// No heading: the first covariance of the orientation is -1, as ROS has it.
template <>
struct RosMessage<rover::Imu> {
  using Type = sensor_msgs::Imu_<Heap<void>>;
  static constexpr std::size_t kDepth = 128;
  static constexpr bool kLatched = false;
  static void to(const rover::Imu& imu, Type& message);
  static bool from(const Type& message, rover::Imu& imu);
};

/// Refused: without cells, with more than an OccupancyGrid holds, or with another number of them
/// than its info has.
template <>
struct RosMessage<rover::OccupancyGrid> {
  using Type = nav_msgs::OccupancyGrid_<Heap<void>>;
  static constexpr std::size_t kDepth = 1;
  static constexpr bool kLatched = true;
  static void to(const rover::OccupancyGrid& grid, Type& message);
  static bool from(const Type& message, rover::OccupancyGrid& grid);
};

}  // namespace ros_bridge
