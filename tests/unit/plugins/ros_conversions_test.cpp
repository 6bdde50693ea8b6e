// SPDX-License-Identifier: LGPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <numbers>

#include "../../../plugins/ros/conversions.h"

namespace {

using ros_bridge::RosMessage;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

template <typename T>
T there_and_back(const T& value) {
  typename RosMessage<T>::Type message;
  RosMessage<T>::to(value, message);
  T back{};
  EXPECT_TRUE(RosMessage<T>::from(message, back));
  return back;
}

TEST(RosConversions, KeepAPoseInAllQuarters) {
  for (double heading = -3.1; heading < 3.2; heading += 0.31) {
    const rover::Pose2D back = there_and_back(rover::Pose2D{1.0, -2.0, heading});

    EXPECT_DOUBLE_EQ(back.x, 1.0);
    EXPECT_DOUBLE_EQ(back.y, -2.0);
    EXPECT_NEAR(back.heading, heading, 1e-12);
  }
}

TEST(RosConversions, TakeAQuaternionThatIsNotNormalisedOrAllZero) {
  RosMessage<rover::Pose2D>::Type message;
  rover::Pose2D pose;
  EXPECT_TRUE(RosMessage<rover::Pose2D>::from(message, pose));
  EXPECT_DOUBLE_EQ(pose.heading, 0.0);

  message.pose.orientation.z = 5.0;
  message.pose.orientation.w = 5.0;
  EXPECT_TRUE(RosMessage<rover::Pose2D>::from(message, pose));
  EXPECT_NEAR(pose.heading, std::numbers::pi / 2.0, 1e-12);
}

TEST(RosConversions, RefuseWhatIsNoNumber) {
  RosMessage<rover::Pose2D>::Type pose;
  pose.pose.position.y = kNan;
  rover::Pose2D into;
  EXPECT_FALSE(RosMessage<rover::Pose2D>::from(pose, into));
  rover::Point2D goal;
  EXPECT_FALSE(RosMessage<rover::Point2D>::from(pose, goal));

  RosMessage<rover::Velocity>::Type twist;
  twist.angular.z = std::numeric_limits<double>::infinity();
  rover::Velocity velocity;
  EXPECT_FALSE(RosMessage<rover::Velocity>::from(twist, velocity));

  RosMessage<rover::Odometry>::Type moved;
  moved.twist.twist.linear.x = kNan;
  rover::Odometry odometry;
  EXPECT_FALSE(RosMessage<rover::Odometry>::from(moved, odometry));

  RosMessage<rover::Imu>::Type turned;
  turned.angular_velocity.z = kNan;
  rover::Imu imu;
  EXPECT_FALSE(RosMessage<rover::Imu>::from(turned, imu));
}

TEST(RosConversions, KeepGoalVelocityAndOdometry) {
  EXPECT_DOUBLE_EQ(there_and_back(rover::Point2D{3.0, 4.0}).y, 4.0);
  const rover::Velocity velocity = there_and_back(rover::Velocity{0.5, -1.0});
  EXPECT_DOUBLE_EQ(velocity.linear, 0.5);
  EXPECT_DOUBLE_EQ(velocity.angular, -1.0);
  const rover::Odometry odometry = there_and_back(rover::Odometry{0.0, 1.0, 2.0, 0.5, 0.7, -0.1});
  EXPECT_DOUBLE_EQ(odometry.y, 2.0);
  EXPECT_NEAR(odometry.heading, 0.5, 1e-12);
  EXPECT_DOUBLE_EQ(odometry.linear, 0.7);
  EXPECT_DOUBLE_EQ(odometry.angular, -0.1);
}

TEST(RosConversions, KeepAJoystickAndCutWhatItCannotHold) {
  rover::Joystick joystick;
  joystick.axes.push_back(-1.0F);
  joystick.axes.push_back(0.5F);
  joystick.buttons = static_cast<std::int32_t>(0x80000005U);
  const rover::Joystick back = there_and_back(joystick);
  EXPECT_EQ(back.axes.size(), 2U);
  EXPECT_FLOAT_EQ(back.axes[1], 0.5F);
  EXPECT_EQ(back.buttons, joystick.buttons);
  EXPECT_TRUE(back.connected);

  RosMessage<rover::Joystick>::Type message;
  message.axes.assign(20, 7.0F);
  message.axes[0] = std::numeric_limits<float>::quiet_NaN();
  message.buttons.assign(100, 0);
  message.buttons[99] = 1;
  rover::Joystick cut;
  ASSERT_TRUE(RosMessage<rover::Joystick>::from(message, cut));
  EXPECT_EQ(cut.axes.size(), rover::Joystick::kAxes);
  EXPECT_FLOAT_EQ(cut.axes[0], 0.0F);
  EXPECT_FLOAT_EQ(cut.axes[1], 1.0F);
  EXPECT_EQ(cut.buttons, 0);
}

TEST(RosConversions, KeepAScanAndRefuseOneThatIsTooLarge) {
  rover::LaserScan scan;
  scan.angle_min = -1.0F;
  scan.angle_increment = 0.5F;
  scan.range_max = 8.0F;
  for (const float range : {1.0F, 2.0F, 3.0F}) scan.ranges.push_back(range);
  RosMessage<rover::LaserScan>::Type message;
  RosMessage<rover::LaserScan>::to(scan, message);
  EXPECT_FLOAT_EQ(message.angle_max, 0.0F);
  EXPECT_FLOAT_EQ(there_and_back(scan).ranges[2], 3.0F);

  message.ranges.assign(rover::LaserScan::kCapacity + 1, 1.0F);
  EXPECT_FALSE(RosMessage<rover::LaserScan>::from(message, scan));
  message.ranges.resize(3);
  message.angle_increment = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(RosMessage<rover::LaserScan>::from(message, scan));
  scan.ranges.clear();
  EXPECT_EQ(there_and_back(scan).ranges.size(), 0U);
}

TEST(RosConversions, DistinguishAHeadingFromNone) {
  rover::Imu imu;
  imu.yaw_rate = 0.3;
  imu.acceleration_x = 1.0;
  EXPECT_FALSE(there_and_back(imu).has_heading);

  imu.has_heading = true;
  imu.heading = -2.0;
  EXPECT_TRUE(there_and_back(imu).has_heading);
  EXPECT_NEAR(there_and_back(imu).heading, -2.0, 1e-12);
  EXPECT_DOUBLE_EQ(there_and_back(imu).acceleration_x, 1.0);

  RosMessage<rover::Imu>::Type zeros;  // who has no compass often says nothing at all
  ASSERT_TRUE(RosMessage<rover::Imu>::from(zeros, imu));
  EXPECT_FALSE(imu.has_heading);
}

class RosMaps : public testing::Test {
 protected:
  void small(std::uint32_t width, std::uint32_t height, std::size_t cells) {
    message_.info.resolution = 0.05F;
    message_.info.width = width;
    message_.info.height = height;
    message_.data.assign(cells, 0);
  }
  bool from() { return RosMessage<rover::OccupancyGrid>::from(message_, *grid_); }

  RosMessage<rover::OccupancyGrid>::Type message_;
  std::unique_ptr<rover::OccupancyGrid> grid_ = std::make_unique<rover::OccupancyGrid>();
};

TEST_F(RosMaps, KeepTheirCells) {
  small(3, 2, 6);
  message_.data[1] = 100;
  message_.data[2] = -1;
  message_.data[3] = 127;
  message_.info.origin.position.x = -4.0;
  ASSERT_TRUE(from());

  EXPECT_EQ(grid_->width, 3);
  EXPECT_EQ(grid_->height, 2);
  EXPECT_EQ(grid_->cells[1], 100);
  EXPECT_EQ(grid_->cells[2], -1);
  EXPECT_EQ(grid_->cells[3], -1);
  EXPECT_DOUBLE_EQ(grid_->origin.x, -4.0);

  RosMessage<rover::OccupancyGrid>::Type again;
  RosMessage<rover::OccupancyGrid>::to(*grid_, again);
  EXPECT_EQ(again.info.width, 3U);
  EXPECT_EQ(again.data.size(), 6U);
  EXPECT_EQ(again.data[1], 100);
}

TEST_F(RosMaps, AreRefusedWhenTheirSizesDoNotFit) {
  small(3, 2, 5);
  EXPECT_FALSE(from());
  small(0, 0, 0);
  EXPECT_FALSE(from());
  small(0xffffffffU, 0xffffffffU, 1);
  EXPECT_FALSE(from());
  small(2048, 2049, 2048UL * 2049UL);
  EXPECT_FALSE(from());
  small(2048, 2048, 2048UL * 2048UL);
  EXPECT_TRUE(from());
}

TEST_F(RosMaps, AreRefusedWithoutAResolution) {
  small(1, 1, 1);
  message_.info.resolution = 0.0F;
  EXPECT_FALSE(from());
  message_.info.resolution = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(from());
}

}  // namespace
