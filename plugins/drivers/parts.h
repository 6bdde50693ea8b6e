// SPDX-License-Identifier: LGPL-3.0-or-later
/// One line for each file of this plugin that offers something.
#pragma once

#include <mauve/plugin.h>

namespace drivers {

void declare_gnss(mauve::Plugin& plugin);
void declare_imu(mauve::Plugin& plugin);
void declare_laser_replay(mauve::Plugin& plugin);
void declare_playback(mauve::Plugin& plugin);
void declare_world(mauve::Plugin& plugin);
void declare_robot_sim(mauve::Plugin& plugin);
void declare_hokuyo(mauve::Plugin& plugin);
void declare_hokuyo_sim(mauve::Plugin& plugin);
void declare_create(mauve::Plugin& plugin);
void declare_create_brake(mauve::Plugin& plugin);
void declare_create_sim(mauve::Plugin& plugin);
void declare_laser_sim(mauve::Plugin& plugin);
void declare_receiver_sim(mauve::Plugin& plugin);
void declare_imu_sim(mauve::Plugin& plugin);

}  // namespace drivers
