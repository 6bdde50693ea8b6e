// SPDX-License-Identifier: LGPL-3.0-or-later
#include "guidance.h"

#include <algorithm>
#include <cmath>

namespace guidance {

double turn_rate(double heading_error, const HeadingLaw& law) {
  const double pull = law.gain * std::sqrt(std::abs(heading_error));
  const double push = law.margin * std::clamp(heading_error / law.layer, -1.0, 1.0);
  return std::clamp(-std::copysign(pull, heading_error) - push, -law.turn_max, law.turn_max);
}

Velocity slewed(const Velocity& last, const Velocity& wanted, const SlewLimits& limits, double dt) {
  // Slowing down towards zero may be quicker than picking up speed, in either direction of travel.
  const bool slower = std::abs(wanted.linear) < std::abs(last.linear);
  const double speed_step = (slower ? limits.slow_down : limits.speed_up) * dt;
  const double turn_step = limits.turn * dt;
  return {std::clamp(wanted.linear, last.linear - speed_step, last.linear + speed_step),
          std::clamp(wanted.angular, last.angular - turn_step, last.angular + turn_step)};
}

}  // namespace guidance
