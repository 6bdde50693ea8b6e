// SPDX-License-Identifier: LGPL-3.0-or-later
/// The Kalman filter of the localization: its models, its honesty, its gate, its way to a heading.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <cmath>
#include <functional>
#include <numbers>

#include "../../../plugins/localization/ekf.h"
#include "../../../plugins/world/random.h"

namespace localization {
namespace {

using rover::Imu;
using rover::Pose;
using rover::Pose2D;
using rover::Twist;

constexpr double kPi = std::numbers::pi;

State random_state(world::Random& random) {
  State state;
  state << random.uniform(-100, 100), random.uniform(-100, 100), random.uniform(-kPi, kPi),
      random.uniform(-3, 8), random.uniform(-2, 2), random.uniform(-0.1, 0.1),
      random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), random.uniform(-0.05, 0.05);
  return state;
}

/// The model's Jacobian against central differences.
template <int N>
void expect_jacobian(const std::function<Model<N>(const State&)>& model, const State& at) {
  constexpr double kStep = 1e-6;
  const Model<N> exact = model(at);
  for (int i = 0; i < kStates; ++i) {
    State above = at;
    State below = at;
    above[i] += kStep;
    below[i] -= kStep;
    Column<N> difference = model(above).value - model(below).value;
    if (N == kStates) difference[kHeading] = rover::wrap(difference[kHeading]);
    const Column<N> error = difference / (2.0 * kStep) - exact.jacobian.col(i);
    EXPECT_LT(error.norm(), 1e-6) << "by state " << i << " at " << at.transpose();
  }
}

TEST(EkfModels, HaveTheJacobiansOfFiniteDifferences) {
  world::Random random(1);
  for (int i = 0; i < 200; ++i) {
    const State state = random_state(random);
    const double dt = random.uniform(0.0, 0.5);
    const rover::Point2D mount{random.uniform(-4, 4), random.uniform(-1, 1)};
    expect_jacobian<kStates>([&](const State& s) { return moved(s, dt); }, state);
    expect_jacobian<2>(seen_by_wheels, state);
    expect_jacobian<1>(seen_by_gyroscope, state);
    expect_jacobian<1>(seen_by_compass, state);
    expect_jacobian<2>([&](const State& s) { return seen_by_antenna(s, mount); }, state);
  }
}

double smallest_eigenvalue(const Estimate& estimate) {
  const Eigen::Map<const Matrix> covariance(estimate.covariance.data());
  EXPECT_EQ((covariance - covariance.transpose()).norm(), 0.0);
  return Eigen::SelfAdjointEigenSolver<Matrix>(covariance, Eigen::EigenvaluesOnly)
      .eigenvalues()
      .minCoeff();
}

bool finite(const Estimate& estimate) {
  return Eigen::Map<const State>(estimate.mean.data()).allFinite() &&
         Eigen::Map<const Matrix>(estimate.covariance.data()).allFinite();
}

TEST(Ekf, KeepsItsCovarianceSymmetricAndPositive) {
  world::Random random(2);
  const Parameters parameters;
  Estimate estimate = begin(parameters, {}, 0.1, 0.05);
  double time = 1.0;
  for (int i = 0; i < 5000; ++i) {
    time += random.uniform(0.0, 1.0) < 0.01 ? random.uniform(0.0, 200.0) : random.uniform(0.0, 0.1);
    const double kind = random.uniform(0.0, 3.0);
    if (kind < 1.0) {
      correct(parameters, Twist{time, random.uniform(-1, 2), random.uniform(-1, 1)}, estimate);
    } else if (kind < 2.0) {
      correct(parameters, Imu{time, random.uniform(-1, 1), 0, 0, random.uniform(-4, 4), i % 7 == 0},
              estimate);
    } else {
      correct(parameters, Pose{time, random.normal(5.0), random.normal(5.0), 0.01}, estimate);
    }
    ASSERT_TRUE(finite(estimate)) << i;
    if (i % 50 == 0) {
      ASSERT_GT(smallest_eigenvalue(estimate), -1e-6) << i;
    }
  }
}

TEST(Ekf, PredictsTheSameInOneStepAndInMany) {
  const Parameters parameters;
  Estimate once = begin(parameters, {1.0, 2.0, 0.5}, 0.1, 0.05);
  correct(parameters, Twist{1.0, 0.8, 0.0}, once);
  Estimate often = once;

  advance(parameters, 1.1, once);
  for (int i = 1; i <= 100; ++i) advance(parameters, 1.0 + i * 0.001, often);

  for (std::size_t i = 0; i < kStates; ++i) EXPECT_NEAR(once.mean[i], often.mean[i], 1e-3);
  for (std::size_t i = 0; i < kStates * kStates; ++i) {
    EXPECT_NEAR(once.covariance[i], often.covariance[i], 2e-3) << i;
  }
}

/// A robot that moves as the filter believes, noises included, and sensors that err as it believes.
struct Truth {
  explicit Truth(std::uint64_t seed, const Parameters& p) : random(seed), parameters(p) {
    state.setZero();
    state[kX] = random.normal(0.1);
    state[kY] = random.normal(0.1);
    state[kHeading] = random.normal(0.05);
    state[kSpeed] = random.normal(1.0);
    state[kTurn] = random.normal(1.0);
    state[kGyroBias] = random.normal(p.gyro_bias);
    state[kScale] = random.normal(p.scale);
    state[kTurnScale] = random.normal(p.turn_scale);
    state[kCurvature] = random.normal(p.curvature);
  }
  void drive(double dt) {
    for (int i = 0; i < 10; ++i) {
      const double way = std::abs(state[kSpeed]) * dt / 10;
      state = moved(state, dt / 10).value;
      state[kX] += random.normal(parameters.slip * std::sqrt(way));
      state[kY] += random.normal(parameters.slip * std::sqrt(way));
      state[kHeading] += random.normal(parameters.heading_slip * std::sqrt(way));
      state[kSpeed] += random.normal(parameters.acceleration * std::sqrt(dt / 10));
      state[kTurn] += random.normal(parameters.turn_acceleration * std::sqrt(dt / 10));
    }
    time += dt;
  }
  Twist wheels() {
    const Column<2> seen = seen_by_wheels(state).value;
    return {time, seen[0] + random.normal(parameters.twist_linear),
            seen[1] + random.normal(parameters.twist_angular)};
  }
  Imu gyroscope() {
    return {time, seen_by_gyroscope(state).value[0] + random.normal(parameters.gyroscope)};
  }
  Pose satellites(double deviation) {
    const Column<2> seen = seen_by_antenna(state, parameters.antenna).value;
    return {time, seen[0] + random.normal(deviation), seen[1] + random.normal(deviation),
            deviation};
  }

  world::Random random;
  Parameters parameters;
  State state;
  double time = 100.0;
};

/// Squared error of place and heading in units of what the filter admits; 3 on average.
double nees(const Estimate& estimate, const State& truth) {
  Eigen::Vector3d error = truth.head<3>() - Eigen::Map<const State>(estimate.mean.data()).head<3>();
  error[2] = rover::wrap(error[2]);
  const Eigen::Matrix3d covariance =
      Eigen::Map<const Matrix>(estimate.covariance.data()).topLeftCorner<3, 3>();
  return error.dot(covariance.inverse() * error);
}

TEST(Ekf, IsAsWrongAsItAdmits) {
  Parameters parameters;
  parameters.antenna = {0.5, 0.2};
  parameters.turn_acceleration = 0.5;
  parameters.gate = 0.0;
  double sum = 0.0;
  double nis = 0.0;
  int inside = 0;
  int fixes = 0;
  constexpr int kRuns = 60;
  for (int run = 0; run < kRuns; ++run) {
    Truth truth(static_cast<std::uint64_t>(run) + 1, parameters);
    Estimate estimate = begin(parameters, {}, 0.1, 0.05);
    for (int i = 0; i < 600; ++i) {
      truth.drive(0.02);
      correct(parameters, truth.wheels(), estimate);
      correct(parameters, truth.gyroscope(), estimate);
      if (i % 10 != 0) continue;
      correct(parameters, truth.satellites(0.5), estimate);
      nis += estimate.nis;
      inside += estimate.nis < 5.991 ? 1 : 0;
      ++fixes;
    }
    sum += nees(estimate, truth.state);
  }
  // 60 runs of 3 degrees of freedom: 99.9 % of the averages lie within 2.0 and 4.2.
  EXPECT_GT(sum / kRuns, 2.0);
  EXPECT_LT(sum / kRuns, 4.2);
  EXPECT_NEAR(nis / fixes, 2.0, 0.2);
  EXPECT_NEAR(static_cast<double>(inside) / fixes, 0.95, 0.02);
}

/// Drives in figures of eight with exact sensors that err by a constant.
Estimate driven(const Parameters& parameters, Estimate estimate, const State& errors,
                double seconds, double speed = 2.0) {
  State truth = errors;
  const double from = estimate.begun ? estimate.time : 10.0;
  const int steps = static_cast<int>(seconds * 50);
  for (int i = 1; i <= steps; ++i) {
    truth[kSpeed] = speed;
    truth[kTurn] = 0.6 * std::sin(0.3 * i * 0.02);
    truth = moved(truth, 0.02).value;
    const double time = from + i * 0.02;
    const Column<2> wheels = seen_by_wheels(truth).value;
    const Column<2> antenna = seen_by_antenna(truth, parameters.antenna).value;
    correct(parameters, Twist{time, wheels[0], wheels[1]}, estimate);
    correct(parameters, Imu{time, seen_by_gyroscope(truth).value[0]}, estimate);
    if (i % 10 == 0) correct(parameters, Pose{time, antenna[0], antenna[1], 0.2}, estimate);
  }
  EXPECT_NEAR(estimate.mean[kX], truth[kX], 0.15);
  EXPECT_NEAR(estimate.mean[kY], truth[kY], 0.15);
  EXPECT_NEAR(rover::wrap(estimate.mean[kHeading] - truth[kHeading]), 0.0, 0.03);
  return estimate;
}

TEST(Ekf, LearnsHowTheWheelsAndTheGyroscopeErr) {
  Parameters parameters;
  parameters.antenna = {1.0, -0.3};
  State errors = State::Zero();
  errors[kGyroBias] = 0.03;
  errors[kScale] = 0.03;
  errors[kTurnScale] = -0.06;
  errors[kCurvature] = 0.004;

  const Estimate estimate = driven(parameters, begin(parameters, {}, 0.1, 0.05), errors, 120.0);

  EXPECT_NEAR(estimate.mean[kGyroBias], 0.03, 0.003);
  EXPECT_NEAR(estimate.mean[kScale], 0.03, 0.005);
  EXPECT_NEAR(estimate.mean[kTurnScale], -0.06, 0.03);
  EXPECT_NEAR(estimate.mean[kCurvature], 0.004, 0.001);
}

TEST(Ekf, LeavesWheelsAloneThatAreSaidToBeRight) {
  Parameters parameters;
  parameters.scale = parameters.turn_scale = parameters.curvature = 0.0;

  const Estimate estimate =
      driven(parameters, begin(parameters, {}, 0.1, 0.05), State::Zero(), 20.0);

  EXPECT_EQ(estimate.mean[kScale], 0.0);
  EXPECT_EQ(estimate.mean[kTurnScale], 0.0);
  EXPECT_EQ(estimate.mean[kCurvature], 0.0);
}

TEST(Ekf, TakesItsHeadingFromTheFirstMetres) {
  const Parameters parameters;
  for (const double speed : {1.0, -1.0}) {
    State start = State::Zero();
    start[kX] = 30.0;
    start[kY] = -20.0;
    start[kHeading] = 2.5;

    const Estimate estimate = driven(parameters, begin(parameters), start, 20.0, speed);

    EXPECT_TRUE(estimate.aligned);
    EXPECT_LT(motion_state(estimate).variance_heading, 0.01);
  }
}

TEST(Ekf, DoesNotPretendToKnowAHeadingAtRest) {
  const Parameters parameters;
  Estimate estimate = begin(parameters);
  for (int i = 1; i <= 600; ++i) {
    correct(parameters, Twist{1.0 + i * 0.1, 0.0, 0.0}, estimate);
    correct(parameters, Pose{1.0 + i * 0.1, 5.0, 5.0, 0.5}, estimate);
  }
  const rover::MotionState state = motion_state(estimate);

  EXPECT_TRUE(estimate.placed);
  EXPECT_FALSE(estimate.aligned);
  EXPECT_GT(state.variance_heading, kPi * kPi / 2);
  EXPECT_NEAR(state.x, 5.0, 0.1);
  EXPECT_LT(state.variance_x, 1.0);
}

TEST(Ekf, TakesItsHeadingFromACompassAcrossTheSeam) {
  const Parameters parameters;
  Estimate estimate = begin(parameters);
  correct(parameters, Imu{1.0, 0.0, 0.0, 0.0, kPi - 0.01, true}, estimate);
  ASSERT_TRUE(estimate.aligned);

  for (int i = 1; i < 20; ++i) {
    correct(parameters, Imu{1.0 + i * 0.1, 0.0, 0.0, 0.0, -kPi + 0.01, true}, estimate);
  }

  EXPECT_GT(std::abs(estimate.mean[kHeading]), 3.1);
  EXPECT_EQ(estimate.outliers, 0u);
}

TEST(EkfGate, RefusesAJumpAndCountsIt) {
  const Parameters parameters;
  Estimate estimate = driven(parameters, begin(parameters, {}, 0.1, 0.05), State::Zero(), 10.0);
  const Estimate before = estimate;

  correct(parameters, Pose{before.time, before.mean[kX] + 8.0, before.mean[kY], 0.2}, estimate);

  EXPECT_EQ(estimate.rejected, 1u);
  EXPECT_EQ(estimate.rejected_recently(), 1);
  EXPECT_GT(estimate.nis, 9.21);
  EXPECT_EQ(estimate.mean, before.mean);
  EXPECT_EQ(estimate.covariance, before.covariance);
}

TEST(EkfGate, GivesInToPositionsThatAgree) {
  const Parameters parameters;
  for (const double jump : {3.0, 500.0}) {
    Estimate estimate = begin(parameters, {}, 0.1, 0.05);
    for (int i = 1; i <= 100; ++i) {
      correct(parameters, Twist{i * 0.1, 0.0, 0.0}, estimate);
      correct(parameters, Pose{i * 0.1, i > 50 ? jump : 0.0, 0.0, 0.2}, estimate);
    }
    EXPECT_EQ(estimate.reacquired, 1u) << jump;
    EXPECT_EQ(estimate.rejected, 10u) << jump;
    EXPECT_NEAR(estimate.mean[kX], jump, 0.2);
  }
}

TEST(EkfGate, NeverGivesInToPositionsThatContradictOneAnother) {
  const Parameters parameters;
  Estimate estimate = begin(parameters, {}, 0.1, 0.05);
  world::Random random(3);
  for (int i = 1; i <= 500; ++i) {
    correct(parameters, Twist{i * 0.1, 0.0, 0.0}, estimate);
    const double angle = i * 2.4;
    correct(parameters, Pose{i * 0.1, 20.0 * std::cos(angle), 20.0 * std::sin(angle), 0.2},
            estimate);
  }
  EXPECT_EQ(estimate.reacquired, 0u);
  EXPECT_EQ(estimate.rejected_recently(), kRecent);
  EXPECT_LT(std::hypot(estimate.mean[kX], estimate.mean[kY]), 1.0);
}

}  // namespace
}  // namespace localization
