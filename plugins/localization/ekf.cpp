// SPDX-License-Identifier: LGPL-3.0-or-later
#include "ekf.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace localization {
namespace {

using rover::MotionState;

constexpr double kLongest = 60.0;  // s of prediction at once
constexpr double kStep = 0.1;      // s of one step of a longer prediction
constexpr int kMostSteps = 60;
constexpr double kUnknownHeading = std::numbers::pi * std::numbers::pi;
constexpr double kFar = 20.0;          // gates away, the filter is not turned but placed
constexpr double kSharpest = 1e-3;     // m, of a position, even if it claims less
constexpr double kUnknownPlace = 1e8;  // m^2
constexpr double kPersists = 2.0;  // s that odd rates or headings agree before they are believed
constexpr double kDrives = 0.2;    // m/s, from which positions show the heading

/// Beyond these variances nothing is known anyway, and numbers shall stay comparable.
constexpr std::array<double, kStates> kLargest{
    kUnknownPlace, kUnknownPlace, kUnknownHeading, 1e4, 1e4, 1.0, 1.0, 1.0, 1.0};
/// Chi-square limits of 99 % for one and two degrees of freedom.
constexpr std::array<double, 3> kGate{0.0, 6.635, 9.210};

Eigen::Map<State> mean_of(Estimate& estimate) { return Eigen::Map<State>(estimate.mean.data()); }
Eigen::Map<Matrix> covariance_of(Estimate& estimate) {
  return Eigen::Map<Matrix>(estimate.covariance.data());
}
Eigen::Map<const Matrix> covariance_of(const Estimate& estimate) {
  return Eigen::Map<const Matrix>(estimate.covariance.data());
}

double square(double value) { return value * value; }

/// Symmetric again, and no variance out of all bounds; scaling keeps it positive.
void store(const Matrix& covariance, Estimate& estimate) {
  Eigen::Map<Matrix> into = covariance_of(estimate);
  into = 0.5 * (covariance + covariance.transpose());
  for (int i = 0; i < kStates; ++i) {
    const double variance = into(i, i);
    const double largest = kLargest[static_cast<std::size_t>(i)];
    if (variance <= largest) continue;
    const double scale = std::sqrt(largest / variance);
    into.row(i) *= scale;
    into.col(i) *= scale;
  }
}

/// White noise on the accelerations, seen through the motion of `dt` seconds.
Matrix process_noise(const Parameters& p, const State& state, double dt) {
  const double cosine = std::cos(state[kHeading] + state[kTurn] * dt / 2.0);
  const double sine = std::sin(state[kHeading] + state[kTurn] * dt / 2.0);
  const double way = std::abs(state[kSpeed]) * dt;
  Matrix noise = Matrix::Zero();
  const Column<2> along(cosine, sine);
  const double speed = square(p.acceleration);
  noise.topLeftCorner<2, 2>() = speed * dt * dt * dt / 3.0 * along * along.transpose();
  noise.block<2, 1>(kX, kSpeed) = speed * dt * dt / 2.0 * along;
  noise.block<1, 2>(kSpeed, kX) = speed * dt * dt / 2.0 * along.transpose();
  noise(kSpeed, kSpeed) = speed * dt;
  const double turn = square(p.turn_acceleration);
  noise(kHeading, kHeading) = turn * dt * dt * dt / 3.0 + square(p.heading_slip) * way;
  noise(kHeading, kTurn) = noise(kTurn, kHeading) = turn * dt * dt / 2.0;
  noise(kTurn, kTurn) = turn * dt;
  noise(kX, kX) += square(p.slip) * way;
  noise(kY, kY) += square(p.slip) * way;
  noise(kGyroBias, kGyroBias) = square(p.gyro_bias_walk) * dt;
  noise(kScale, kScale) = p.scale > 0.0 ? square(p.scale_walk) * dt : 0.0;
  noise(kTurnScale, kTurnScale) = p.turn_scale > 0.0 ? square(p.scale_walk) * dt : 0.0;
  noise(kCurvature, kCurvature) = p.curvature > 0.0 ? square(p.curvature_walk) * dt : 0.0;
  return noise;
}

/// The difference between a measurement and the expectation of the filter.
template <int N>
struct Innovation {
  Column<N> value;
  Rows<N> jacobian;
  Eigen::Matrix<double, N, N> noise;
  Eigen::Matrix<double, N, N> inverse;  ///< of its covariance
  double nis = 0.0;
};

template <int N>
Innovation<N> innovation(const Estimate& estimate, const Model<N>& expected,
                         const Column<N>& measured, const Column<N>& variance) {
  Innovation<N> result;
  result.value = measured - expected.value;
  result.jacobian = expected.jacobian;
  result.noise = variance.asDiagonal();
  const Eigen::Matrix<double, N, N> covariance =
      result.jacobian * covariance_of(estimate) * result.jacobian.transpose() + result.noise;
  result.inverse = covariance.inverse();
  result.nis = result.value.dot(result.inverse * result.value);
  return result;
}

template <int N>
bool inside(const Parameters& p, const Innovation<N>& innovation) {
  return p.gate <= 0.0 || innovation.nis <= p.gate * kGate[N];
}

/// Joseph's form: stays positive with any gain.
template <int N>
void apply(const Innovation<N>& innovation, Estimate& estimate) {
  const Eigen::Map<Matrix> covariance = covariance_of(estimate);
  const Eigen::Matrix<double, kStates, N> gain =
      covariance * innovation.jacobian.transpose() * innovation.inverse;
  const Matrix rest = Matrix::Identity() - gain * innovation.jacobian;
  Eigen::Map<State> mean = mean_of(estimate);
  mean += gain * innovation.value;
  mean[kHeading] = rover::wrap(mean[kHeading]);
  store(rest * covariance * rest.transpose() + gain * innovation.noise * gain.transpose(),
        estimate);
}

/// A reading contradicts the others, which costs them.
void doubt(Rival& rival) {
  constexpr int kCost = 5;  // readings: a compass with a glitch each second gets its way, but not
                            // one that contradicts itself in one reading of six
  rival.agreeing = std::max(0, rival.agreeing - kCost);
  if (rival.agreeing == 0) rival = {};
}

/// Measurements that stay outside the gate and agree with one another, for long enough, are right.
template <int N>
bool gives_in(const Parameters& p, const Innovation<N>& seen, Rival& rival,
              const Estimate& estimate) {
  double apart = 0.0;
  for (int i = 0; i < N; ++i) {
    apart += square(seen.value[i] - rival.offset[static_cast<std::size_t>(i)]) / seen.noise(i, i);
  }
  if (rival.agreeing > 0 && apart > kGate[N]) doubt(rival);
  if (rival.agreeing > 0 && apart > kGate[N]) return false;
  if (rival.agreeing == 0) rival.since = estimate.time;
  for (int i = 0; i < N; ++i) rival.offset[static_cast<std::size_t>(i)] = seen.value[i];
  ++rival.agreeing;
  return p.reacquire_after > 0 && rival.agreeing >= p.reacquire_after &&
         estimate.time - rival.since >= kPersists;
}

/// Corrects by rates. Outside the gate they only count, until they persist: the filter was too sure
/// of these two states then.
template <int N>
void take(const Parameters& p, const Innovation<N>& seen, const std::array<int, 2>& states,
          Rival& rival, Estimate& estimate) {
  if (!inside(p, seen)) {
    ++estimate.outliers;
    if (!gives_in(p, seen, rival, estimate)) return;
    ++estimate.reacquired;
    Matrix covariance = covariance_of(estimate);
    for (const int state : states) {
      covariance.row(state) *= std::sqrt(seen.nis);
      covariance.col(state) *= std::sqrt(seen.nis);
    }
    store(covariance, estimate);
    Innovation<N> again = seen;
    again.inverse =
        (seen.jacobian * covariance_of(estimate) * seen.jacobian.transpose() + seen.noise)
            .inverse();
    rival = {};
    return apply(again, estimate);
  }
  doubt(rival);
  apply(seen, estimate);
}

/// Turns everything by `angle`, known to `variance`, about the anchor.
void turn(double angle, double variance, Estimate& estimate) {
  Eigen::Map<State> mean = mean_of(estimate);
  const Column<2> anchor(estimate.anchor.x, estimate.anchor.y);
  Eigen::Matrix2d rotation;
  rotation << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
  const Column<2> arm = rotation * (mean.head<2>() - anchor);
  mean.head<2>() = anchor + arm;
  mean[kHeading] = rover::wrap(mean[kHeading] + angle);
  Matrix jacobian = Matrix::Identity();
  jacobian.topLeftCorner<2, 2>() = rotation;
  State by_angle = State::Zero();
  by_angle.head<3>() << -arm[1], arm[0], 1.0;
  store(jacobian * covariance_of(estimate) * jacobian.transpose() +
            variance * by_angle * by_angle.transpose(),
        estimate);
}

/// Corrects by a compass, likewise: the filter takes a heading that persists for its own.
void take_heading(const Parameters& p, double heading, Estimate& estimate) {
  Eigen::Map<State> mean = mean_of(estimate);
  const double error = rover::wrap(heading - mean[kHeading]);
  const Innovation<1> seen =
      innovation<1>(estimate, seen_by_compass(mean), Column<1>(mean[kHeading] + error),
                    Column<1>(square(p.compass)));
  if (inside(p, seen)) {
    doubt(estimate.odd_heading);
    return apply(seen, estimate);
  }
  ++estimate.outliers;
  Innovation<1> odd = seen;  // 3.1 and -3.1 rad are near each other
  const double before = estimate.odd_heading.offset[0];
  odd.value[0] = before + rover::wrap(error - before);
  if (!gives_in(p, odd, estimate.odd_heading, estimate)) return;
  ++estimate.reacquired;
  estimate.odd_heading = {};
  mean[kHeading] = rover::wrap(heading);
  Matrix covariance = covariance_of(estimate);
  covariance.row(kHeading).setZero();
  covariance.col(kHeading).setZero();
  covariance(kHeading, kHeading) = square(p.compass);
  store(covariance, estimate);
}

/// A position as the filter takes it.
struct Position {
  Column<2> at;
  double variance;

  Position(const Parameters& p, const rover::Pose& pose)
      : at(pose.x, pose.y),
        variance(square(pose.deviation > 0.0 ? std::max(pose.deviation, kSharpest) : p.position)) {}
};

Column<2> antenna_at(const Parameters& p, const Estimate& estimate) {
  return seen_by_antenna(Eigen::Map<const State>(estimate.mean.data()), p.antenna).value;
}

Innovation<2> innovation(const Parameters& p, const Position& position, const Estimate& estimate) {
  const Eigen::Map<const State> mean(estimate.mean.data());
  return innovation<2>(estimate, seen_by_antenna(mean, p.antenna), position.at,
                       Column<2>::Constant(position.variance));
}

/// Moves the antenna to the position, regardless of the estimate before.
void place(const Parameters& p, const Position& position, Estimate& estimate) {
  mean_of(estimate).head<2>() += position.at - antenna_at(p, estimate);
  Matrix covariance = covariance_of(estimate);
  covariance.topRows<2>().setZero();
  covariance.leftCols<2>().setZero();
  covariance.topLeftCorner<2, 2>().diagonal().setConstant(position.variance);
  store(covariance, estimate);
  estimate.anchor = {position.at[0], position.at[1]};
  estimate.placed = true;
}

/// The way since the anchor, by the positions and by the wheels, gives the heading.
void align(const Parameters& p, const Position& position, Estimate& estimate) {
  const double variance = 2.0 * position.variance;
  const Column<2> anchor(estimate.anchor.x, estimate.anchor.y);
  const Column<2> driven = antenna_at(p, estimate) - anchor;
  const Column<2> seen = position.at - anchor;
  const double way = driven.norm();
  if (std::abs(way - seen.norm()) > 3.0 * std::sqrt(variance) + 0.2 * way) {
    ++estimate.rejected;  // one of the two positions is wrong: from here, then
    place(p, position, estimate);
    return;
  }
  ++estimate.accepted;
  if (way < std::max(p.align_distance, 2.0 * std::sqrt(variance))) return;
  turn(std::atan2(seen[1], seen[0]) - std::atan2(driven[1], driven[0]), variance / square(way),
       estimate);
  estimate.aligned = true;
}

/// The filter was too sure of itself: place and heading turn to the position together. From too far
/// away for that, it is placed anew.
void believe(const Parameters& p, const Position& position, double nis, Estimate& estimate) {
  if (nis > kFar * p.gate * kGate[2]) return place(p, position, estimate);
  const double factor = std::sqrt(nis / 2.0);
  Matrix covariance = covariance_of(estimate);
  covariance.topRows<3>() *= factor;
  covariance.leftCols<3>() *= factor;
  store(covariance, estimate);
  apply(innovation(p, position, estimate), estimate);
}

/// Positions that stay outside the gate and agree with one another are right: the filter is not.
/// True when that is so.
bool gives_in(const Parameters& p, const Position& position, const Innovation<2>& seen,
              Estimate& estimate) {
  const Column<2> before(estimate.offset.x, estimate.offset.y);
  const bool agrees = (seen.value - before).squaredNorm() <= kGate[2] * position.variance;
  estimate.agreeing = agrees ? estimate.agreeing + 1 : 1;
  estimate.offset = {seen.value[0], seen.value[1]};
  return p.reacquire_after > 0 && estimate.agreeing >= p.reacquire_after;
}

}  // namespace

void advance(const Parameters& p, double time, Estimate& estimate) {
  if (!estimate.begun) {
    estimate.begun = true;
    estimate.time = time;
    estimate.pose_time = time;
  }
  const double gap = std::min(time - estimate.time, kLongest);
  if (!(gap > 0.0)) return;
  estimate.time = time;
  const int steps = static_cast<int>(std::clamp(std::ceil(gap / kStep), 1.0, double{kMostSteps}));
  for (int i = 0; i < steps; ++i) {
    const Model<kStates> model = moved(mean_of(estimate), gap / steps);
    const Matrix noise = process_noise(p, mean_of(estimate), gap / steps);
    store(model.jacobian * covariance_of(estimate) * model.jacobian.transpose() + noise, estimate);
    mean_of(estimate) = model.value;
  }
}

void correct(const Parameters& p, const rover::Twist& twist, Estimate& estimate) {
  advance(p, twist.time, estimate);
  take(p,
       innovation<2>(estimate, seen_by_wheels(mean_of(estimate)), {twist.linear, twist.angular},
                     {square(p.twist_linear), square(p.twist_angular)}),
       {kSpeed, kTurn}, estimate.odd_wheels, estimate);
}

void correct(const Parameters& p, const rover::Imu& imu, Estimate& estimate) {
  advance(p, imu.time, estimate);
  take(p,
       innovation<1>(estimate, seen_by_gyroscope(mean_of(estimate)), Column<1>(imu.yaw_rate),
                     Column<1>(square(p.gyroscope))),
       {kTurn, kGyroBias}, estimate.odd_gyroscope, estimate);
  if (!imu.has_heading) return;
  if (!estimate.aligned) {
    turn(imu.heading - mean_of(estimate)[kHeading], square(p.compass), estimate);
    estimate.aligned = true;
    return;
  }
  take_heading(p, imu.heading, estimate);
}

void correct(const Parameters& p, const rover::Pose& pose, Estimate& estimate) {
  advance(p, pose.time, estimate);
  const Position position(p, pose);
  estimate.recent = (estimate.recent << 1U) & ((1U << kRecent) - 1U);
  if (!estimate.placed) {
    place(p, position, estimate);
    estimate.pose_time = pose.time;
    ++estimate.accepted;
    return;
  }
  if (!estimate.aligned) {
    align(p, position, estimate);
    estimate.pose_time = pose.time;
    return;
  }
  const Innovation<2> seen = innovation(p, position, estimate);
  estimate.nis = seen.nis;
  if (inside(p, seen)) {
    apply(seen, estimate);
    ++estimate.accepted;
    // The way that was driven is right, and so is its direction.
    if (std::abs(mean_of(estimate)[kSpeed]) > kDrives) estimate.odd_heading = {};
  } else {
    estimate.recent |= 1U;
    ++estimate.rejected;
    if (!gives_in(p, position, seen, estimate)) return;
    believe(p, position, seen.nis, estimate);
    ++estimate.reacquired;
  }
  estimate.agreeing = 0;
  estimate.pose_time = pose.time;
}

MotionState motion_state(const Estimate& estimate) {
  Estimate shown = estimate;
  if (!shown.aligned) turn(0.0, kUnknownHeading, shown);
  const Eigen::Map<const Matrix> covariance = covariance_of(std::as_const(shown));
  const State mean = mean_of(shown);
  MotionState state{shown.time, mean[kX], mean[kY], mean[kHeading], mean[kSpeed], mean[kTurn], 0.0,
                    0.0,        0.0,      0.0};
  state.variance_x = shown.placed ? covariance(kX, kX) : kUnknownPlace;
  state.variance_y = shown.placed ? covariance(kY, kY) : kUnknownPlace;
  state.covariance_xy = shown.placed ? covariance(kX, kY) : 0.0;
  state.variance_heading = covariance(kHeading, kHeading);
  return state;
}

}  // namespace localization
