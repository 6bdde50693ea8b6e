// SPDX-License-Identifier: LGPL-3.0-or-later
/// A vehicle that steers its front wheels and measures one rear wheel: its motion as it measures
/// it. A steering wheel that is not straight and a worn tyre are left to the filter (`curvature`
/// and `scale` in models.h). A wrong angle e turns by speed * e / wheelbase too much.
#pragma once

#include <cmath>

#include "../types/motion.h"

namespace localization {

/// Metres.
struct Ackermann {
  double wheelbase = 2.83;
  double wheel_offset = 0.76;  ///< of the measured rear wheel, to the left of the middle
};

/// Speeds of the middle of the rear axle. [rt]
inline rover::Twist twist_of(const Ackermann& vehicle, double time, double wheel_speed,
                             double steering) {
  const double curvature = std::tan(steering) / vehicle.wheelbase;
  const double speed = wheel_speed / (1.0 - curvature * vehicle.wheel_offset);
  return {time, speed, speed * curvature};
}

}  // namespace localization
