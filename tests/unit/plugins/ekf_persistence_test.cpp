// SPDX-License-Identifier: LGPL-3.0-or-later
/// Compass readings and rates outside the gate: which the filter believes in the end.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "../../../plugins/localization/ekf.h"

namespace localization {
namespace {

using rover::Imu;
using rover::Pose;
using rover::Twist;

/// A standing robot that is placed, and whose first compass reading is `first`.
Estimate standing(const Parameters& parameters, double first) {
  Estimate estimate = begin(parameters);
  correct(parameters, Pose{0.0, 0.0, 0.0, 0.5}, estimate);
  correct(parameters, Imu{0.0, 0.0, 0.0, 0.0, first, true}, estimate);
  return estimate;
}

TEST(EkfPersistence, GivesInToACompassWhoseReadingsAgree) {
  const Parameters parameters;
  for (const double first : {2.9, -2.9, 3.14, 0.6}) {
    Estimate estimate = standing(parameters, first);
    for (int i = 1; i <= 500; ++i) {
      const double noise = 0.02 * std::sin(i * 1.7);
      correct(parameters, Imu{i * 0.01, 0.0, 0.0, 0.0, noise, true}, estimate);
      correct(parameters, Twist{i * 0.01, 0.0, 0.0}, estimate);
    }
    EXPECT_NEAR(estimate.mean[kHeading], 0.0, 0.05) << first;
    EXPECT_EQ(estimate.reacquired, 1u) << first;
    EXPECT_LT(estimate.outliers, 220u) << first;
  }
}

TEST(EkfPersistence, GivesInToACompassWithAGlitchNowAndThen) {
  const Parameters parameters;
  for (const double glitch : {-1.2, 2.9}) {
    Estimate estimate = standing(parameters, 2.9);
    for (int i = 1; i <= 1000; ++i) {
      const double heading = i % 60 == 0 ? glitch : 0.0;
      correct(parameters, Imu{i * 0.025, 0.0, 0.0, 0.0, heading, true}, estimate);
    }
    EXPECT_NEAR(estimate.mean[kHeading], 0.0, 0.05) << glitch;
  }
}

TEST(EkfPersistence, GivesInToACompassAcrossTheSeam) {
  const Parameters parameters;
  Estimate estimate = standing(parameters, 0.0);
  for (int i = 1; i <= 60; ++i) {
    const double heading = i % 2 == 0 ? std::numbers::pi - 0.01 : -std::numbers::pi + 0.01;
    correct(parameters, Imu{i * 0.1, 0.0, 0.0, 0.0, heading, true}, estimate);
  }
  EXPECT_GT(std::abs(estimate.mean[kHeading]), 3.1);
}

TEST(EkfPersistence, NeverGivesInToACompassThatIsDisturbedShortlyOrContradictsItself) {
  const Parameters parameters;
  Estimate estimate = standing(parameters, 0.0);
  for (int i = 1; i <= 1000; ++i) {
    const double odd = i < 500 ? (i % 200 < 100 ? 1.5 : 0.0) : 2.0 * std::sin(i * 2.4);
    correct(parameters, Imu{i * 0.01, 0.0, 0.0, 0.0, odd, true}, estimate);
  }
  EXPECT_EQ(estimate.reacquired, 0u);
  EXPECT_NEAR(estimate.mean[kHeading], 0.0, 0.1);
}

TEST(EkfPersistence, ACompassThatIsWrongLosesToTheWayThatPositionsShow) {
  const Parameters parameters;
  Estimate estimate = begin(parameters, {}, 0.1, 0.05);
  for (int i = 1; i <= 2000; ++i) {
    const double time = i * 0.01;
    correct(parameters, Twist{time, 1.0, 0.0}, estimate);
    correct(parameters, Imu{time, 0.0, 0.0, 0.0, 1.5, true}, estimate);
    if (i % 100 == 0) correct(parameters, Pose{time, time, 0.0, 0.5}, estimate);
  }
  EXPECT_EQ(estimate.reacquired, 0u);
  EXPECT_NEAR(estimate.mean[kHeading], 0.0, 0.1);
}

TEST(EkfPersistence, GivesInToAGyroscopeWhoseBiasIsBeyondAllExpectation) {
  const Parameters parameters;
  Estimate estimate = standing(parameters, 0.0);
  for (int i = 1; i <= 3000; ++i) {
    correct(parameters, Twist{i * 0.01, 0.0, 0.0}, estimate);
    correct(parameters, Imu{i * 0.01, 0.9, 0.0, 0.0, 0.0, true}, estimate);
  }
  EXPECT_GE(estimate.reacquired, 1u);
  EXPECT_NEAR(estimate.mean[kGyroBias], 0.9, 0.1);
  EXPECT_NEAR(estimate.mean[kTurn], 0.0, 0.1);
  EXPECT_NEAR(estimate.mean[kHeading], 0.0, 0.1);
}

}  // namespace
}  // namespace localization
