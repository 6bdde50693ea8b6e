// SPDX-License-Identifier: LGPL-3.0-or-later
/// The report of a joystick: joystick/1.
#pragma once

#include <cstdint>

#include <mauve/bounded.h>
#include <mauve/type.h>

namespace rover {

/// Axes and buttons as they are now. The default is a joystick that is not there.
struct Joystick {
  static constexpr std::size_t kAxes = 8;

  double time = 0.0;                  ///< s, monotonic clock, of the last event
  mauve::Bounded<float, kAxes> axes;  ///< -1 to 1; forward and left are positive
  std::int32_t buttons = 0;           ///< bit i: button i is pressed
  bool connected = false;

  static constexpr std::string_view type_name = "joystick/1";
  static constexpr auto fields() {
    return std::tuple{
        mauve::field("time", &Joystick::time, "s", "monotonic clock; of the last event"),
        mauve::field("axes", &Joystick::axes, "", "-1 to 1; forward and left are positive"),
        mauve::field("buttons", &Joystick::buttons, "", "a bit for each"),
        mauve::field("connected", &Joystick::connected)};
  }
};

}  // namespace rover
