// SPDX-License-Identifier: LGPL-3.0-or-later
#include "ekf_resource.h"

#include <cmath>

#include "../types/reporting.h"

namespace localization {

using rover::MotionState;
using rover::Pose2D;

mauve::Status EkfCore::on_configure() {
  localization::start(start_known
                          ? begin(parameters, start, start_deviation, start_heading_deviation)
                          : begin(parameters),
                      *memory_);
  return mauve::ok();
}

void EkfCore::show_counts(double time) {
  const Estimate& estimate = memory_->estimate;
  accepted = estimate.accepted;
  rejected = estimate.rejected;
  rejected_recently = estimate.rejected_recently();
  reacquired = estimate.reacquired;
  outliers = estimate.outliers;
  late = memory_->late;
  dropped_ = memory_->refused != refused || memory_->too_late != too_late;
  too_late = memory_->too_late;
  if (memory_->refused != refused && rover::worth_reporting(memory_->refused)) {
    mauve::log(mauve::LogLevel::warning, "{} measurements that are no numbers", memory_->refused);
  }
  refused = memory_->refused;
  innovation = estimate.nis;
  dispersion = estimate.dispersion();
  pose_age = estimate.begun ? time - estimate.pose_time : 0.0;
  placed = estimate.placed;
  aligned = estimate.aligned;
  tell(time);
}

/// Looks whether service `pose` has data now, and why not.
void EkfCore::tell(double time) {
  const Estimate& estimate = memory_->estimate;
  const bool blind = !estimate.begun || time - estimate.time > blind_after;
  if (blind && dropped_) {
    silence_.look("its measurements are no numbers, too late, or of another clock");
  } else if (blind) {
    silence_.look("nothing is measured");
  } else if (!estimate.placed) {
    silence_.look("no position has come");
  } else if (!estimate.aligned) {
    silence_.look("its heading is not known: no compass, and too few metres driven");
  } else {
    silence_.ended();
  }
}

Estimate EkfCore::estimate_at(double time) {
  Estimate estimate = predicted(parameters, time, *memory_);
  if (!estimate.begun) estimate.time = time;
  return estimate;
}

std::optional<MotionState> EkfCore::predict() {
  const double time = now();
  const Estimate estimate = estimate_at(time);
  dispersion = estimate.dispersion();
  pose_age = estimate.begun ? time - estimate.pose_time : 0.0;
  tell(time);
  if (!estimate.placed) return {};
  return motion_state(estimate);
}

MotionState EkfCore::predict_at(double time) {
  if (!std::isfinite(time)) time = 0.0;
  const Estimate estimate = estimate_at(time == 0.0 ? now() : time);
  MotionState state = motion_state(estimate);
  if (!estimate.placed) state.time = 0.0;
  return state;
}

std::optional<Pose2D> EkfCore::pose() {
  tell(now());
  if (!memory_->estimate.aligned) return {};
  if (memory_->estimate.begun && now() - memory_->estimate.time > blind_after) return {};
  const std::optional<MotionState> state = predict();
  if (!state) return {};
  return Pose2D{state->x, state->y, state->heading};
}

}  // namespace localization
