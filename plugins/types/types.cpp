// SPDX-License-Identifier: LGPL-3.0-or-later
/// Plugin "types": the data types that the robot's plugins exchange.
#include <mauve/plugin.h>

#include "gnss.h"
#include "grid.h"
#include "imu.h"
#include "joystick.h"
#include "motion.h"
#include "pose.h"
#include "scan.h"
#include "velocity.h"

MAUVE_PLUGIN(plugin) {
  plugin.type<rover::Pose2D>();
  plugin.type<rover::Point2D>();
  plugin.type<rover::Odometry>();
  plugin.type<rover::Velocity>();
  plugin.type<rover::LaserScan>();
  plugin.type<rover::GnssFix>();
  plugin.type<rover::Imu>();
  plugin.type<rover::Twist>();
  plugin.type<rover::Pose>();
  plugin.type<rover::MotionState>();
  plugin.type<rover::Joystick>();
  plugin.type<rover::OccupancyGrid>();
  plugin.type<rover::Path>();
}
