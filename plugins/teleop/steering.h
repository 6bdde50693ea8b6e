// SPDX-License-Identifier: LGPL-3.0-or-later
/// The command that a joystick gives to the robot.
#pragma once

#include <optional>
#include <tuple>

#include <mauve/property.h>

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

  static auto parameters() {
    using mauve::parameter;
    constexpr int kLastAxis = static_cast<int>(rover::Joystick::kAxes) - 1;
    return std::tuple{
        parameter("linear_axis", &Controls::linear_axis, "axis that drives forward",
                  {.min = 0, .max = kLastAxis}),
        parameter("angular_axis", &Controls::angular_axis, "axis that turns",
                  {.min = 0, .max = kLastAxis}),
        parameter("dead_zone", &Controls::dead_zone, "share of an axis that counts as its middle",
                  {.min = 0.0, .max = 0.9}),
        parameter("max_linear", &Controls::max_linear, "at a full axis",
                  {.unit = "m/s", .min = 0.0, .max = 20.0}),
        parameter("max_angular", &Controls::max_angular, "at a full axis",
                  {.unit = "rad/s", .min = 0.0, .max = 20.0}),
        parameter("dead_man", &Controls::dead_man,
                  "button to hold while steering; -1: none, moving an axis steers",
                  {.min = -1, .max = 31})};
  }
};

/// The wanted velocity; empty while no person steers: no joystick, the dead-man button is not held,
/// or, where there is none, both axes rest. An axis that is missing or not a number rests. [rt]
[[nodiscard]] std::optional<rover::Velocity> steer(const rover::Joystick& joystick,
                                                   const Controls& controls);

}  // namespace teleop
