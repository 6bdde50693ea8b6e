// SPDX-License-Identifier: LGPL-3.0-or-later
/// The command that a joystick gives to the robot.
#pragma once

#include <optional>

#include "../types/joystick.h"
#include "../types/velocity.h"

namespace teleop {

/// How axes and buttons are meant.
struct Controls {
  int linear_axis = 1;
  int angular_axis = 0;
  double dead_zone = 0.1;    ///< share of an axis around its middle that counts as the middle
  double max_linear = 0.5;   ///< m/s, of a full axis
  double max_angular = 1.0;  ///< rad/s
  int dead_man = 0;          ///< the button that must be held; -1: none
};

/// The velocity wanted; empty while nobody steers: no joystick, the dead-man button is not held,
/// or, where there is none, both axes rest. An axis that is missing or not a number rests. [rt]
[[nodiscard]] std::optional<rover::Velocity> steer(const rover::Joystick& joystick,
                                                   const Controls& controls);

}  // namespace teleop
