// SPDX-License-Identifier: LGPL-3.0-or-later
/// How fast a ground robot moves or shall move: velocity/1.
#pragma once

#include <mauve/type.h>

namespace rover {

/// Speeds in the robot's own frame. The default stands still, which is the safe value of every
/// command.
struct Velocity {
  double linear = 0.0;   ///< m/s, forward
  double angular = 0.0;  ///< rad/s, anticlockwise

  static constexpr std::string_view type_name = "velocity/1";
  static constexpr auto fields() {
    return std::tuple{mauve::field("linear", &Velocity::linear, "m/s", "forward"),
                      mauve::field("angular", &Velocity::angular, "rad/s", "anticlockwise")};
  }
};

}  // namespace rover
