// SPDX-License-Identifier: LGPL-3.0-or-later
/// Plugin "drivers": actuators and sensors, real and simulated.
#include "parts.h"

MAUVE_PLUGIN(plugin) {
  drivers::declare_gnss(plugin);
  drivers::declare_imu(plugin);
  drivers::declare_laser_replay(plugin);
  drivers::declare_playback(plugin);
  drivers::declare_world(plugin);
  drivers::declare_robot_sim(plugin);
  drivers::declare_hokuyo(plugin);
  drivers::declare_hokuyo_sim(plugin);
  drivers::declare_create(plugin);
  drivers::declare_create_brake(plugin);
  drivers::declare_create_sim(plugin);
  drivers::declare_laser_sim(plugin);
  drivers::declare_receiver_sim(plugin);
  drivers::declare_imu_sim(plugin);
}
