// SPDX-License-Identifier: LGPL-3.0-or-later
/// Component kinds "drivers/playback_TYPE": they play recordings of `mauvectl record` into an
/// architecture. Example: mauvectl get player.core.played player.core.finished
#include "playback.h"

#include "../../types/grid.h"
#include "../../types/imu.h"
#include "../../types/joystick.h"
#include "../../types/motion.h"
#include "../../types/pose.h"
#include "../../types/scan.h"
#include "../../types/velocity.h"
#include "../parts.h"

namespace drivers {

void declare_playback(mauve::Plugin& plugin) {
  declare_playback_of<rover::GnssFix>(plugin, "playback_gnss_fix");
  declare_playback_of<rover::Imu>(plugin, "playback_imu");
  declare_playback_of<rover::Joystick>(plugin, "playback_joystick");
  declare_playback_of<rover::LaserScan>(plugin, "playback_laser_scan");
  declare_playback_of<rover::MotionState>(plugin, "playback_motion_state");
  declare_playback_of<rover::Odometry>(plugin, "playback_odometry");
  declare_playback_of<rover::Path>(plugin, "playback_path");
  declare_playback_of<rover::Point2D>(plugin, "playback_point2d");
  declare_playback_of<rover::Pose>(plugin, "playback_pose");
  declare_playback_of<rover::Pose2D>(plugin, "playback_pose2d");
  declare_playback_of<rover::Twist>(plugin, "playback_twist");
  declare_playback_of<rover::Velocity>(plugin, "playback_velocity");
}

}  // namespace drivers
