// SPDX-License-Identifier: LGPL-3.0-or-later
#include "steering.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace teleop {
namespace {

/// -1 to 1, and 0 within the dead zone; without a jump at its edge.
double deflection(const rover::Joystick& joystick, int axis, double dead_zone) {
  const auto index = static_cast<std::size_t>(axis);
  if (axis < 0 || index >= joystick.axes.size()) return 0.0;
  const double raw = static_cast<double>(joystick.axes[index]);
  if (!std::isfinite(raw)) return 0.0;
  const double size = std::min(std::abs(raw), 1.0);
  if (size <= dead_zone) return 0.0;
  return std::copysign((size - dead_zone) / (1.0 - dead_zone), raw);
}

bool pressed(const rover::Joystick& joystick, int button) {
  return ((static_cast<std::uint32_t>(joystick.buttons) >> button) & 1U) != 0;
}

}  // namespace

std::optional<rover::Velocity> steer(const rover::Joystick& joystick, const Controls& controls) {
  if (!joystick.connected) return std::nullopt;
  const double linear = deflection(joystick, controls.linear_axis, controls.dead_zone);
  const double angular = deflection(joystick, controls.angular_axis, controls.dead_zone);
  const bool held = controls.dead_man >= 0 ? pressed(joystick, controls.dead_man)
                                           : linear != 0.0 || angular != 0.0;
  if (!held) return std::nullopt;
  return rover::Velocity{linear * controls.max_linear, angular * controls.max_angular};
}

}  // namespace teleop
