// SPDX-License-Identifier: LGPL-3.0-or-later
/// Extended Kalman filter of a ground robot (paper 5.3): wheels, gyroscope, compass and satellites
/// in any order and rate. Plain bytes and pure functions: no clock, no heap.
///
/// Where nothing is known at first, the filter counts from an arbitrary place and direction. The
/// first position places it, the first metres turn it (`Estimate::placed`, `aligned`), by a
/// rotation about the first position that carries the covariance along.
#pragma once

#include "../types/imu.h"
#include "../types/motion.h"
#include "estimate.h"

namespace localization {

/// Predicts to the time; earlier ones change nothing, and more than a minute counts as one. [rt]
void advance(const Parameters& parameters, double time, Estimate& estimate);

/// Advances to the time of the measurement, then corrects. The measurement is finite. [rt]
void correct(const Parameters& parameters, const rover::Twist& twist, Estimate& estimate);
void correct(const Parameters& parameters, const rover::Imu& imu, Estimate& estimate);
void correct(const Parameters& parameters, const rover::Pose& pose, Estimate& estimate);

/// The estimate as others want it. An unknown value has a large variance. [rt]
[[nodiscard]] rover::MotionState motion_state(const Estimate& estimate);

}  // namespace localization
