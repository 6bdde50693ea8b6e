// SPDX-License-Identifier: LGPL-3.0-or-later
/// The knowledge of the filter at first, and two measures of it.
#include "estimate.h"

#include <bit>
#include <cmath>

namespace localization {
namespace {

double variance_of(double deviation) { return deviation * deviation; }

}  // namespace

double Estimate::dispersion() const {
  const Eigen::Map<const Matrix> p(covariance.data());
  const double middle = (p(kX, kX) + p(kY, kY)) / 2.0;
  return std::sqrt(middle + std::hypot((p(kX, kX) - p(kY, kY)) / 2.0, p(kX, kY)));
}

int Estimate::rejected_recently() const { return std::popcount(recent); }

Estimate begin(const Parameters& p) {
  Estimate estimate;
  Eigen::Map<Matrix> covariance(estimate.covariance.data());
  covariance(kSpeed, kSpeed) = 1.0;
  covariance(kTurn, kTurn) = 1.0;
  covariance(kGyroBias, kGyroBias) = variance_of(p.gyro_bias);
  covariance(kScale, kScale) = variance_of(p.scale);
  covariance(kTurnScale, kTurnScale) = variance_of(p.turn_scale);
  covariance(kCurvature, kCurvature) = variance_of(p.curvature);
  return estimate;
}

Estimate begin(const Parameters& p, const rover::Pose2D& start, double deviation,
               double heading_deviation) {
  Estimate estimate = begin(p);
  estimate.mean[kX] = start.x;
  estimate.mean[kY] = start.y;
  estimate.mean[kHeading] = rover::wrap(start.heading);
  Eigen::Map<Matrix> covariance(estimate.covariance.data());
  covariance(kX, kX) = covariance(kY, kY) = variance_of(deviation);
  covariance(kHeading, kHeading) = variance_of(heading_deviation);
  estimate.placed = true;
  estimate.aligned = true;
  estimate.anchor = {start.x, start.y};
  return estimate;
}

}  // namespace localization
