// SPDX-License-Identifier: LGPL-3.0-or-later
/// The filter's models of motion and sensors, each with its Jacobian. Pure functions.
///
/// The wheels err in three ways that GNSS distinguishes. All speeds err by the same share (`scale`:
/// worn tyres). All turns err by the same share (`turn_scale`: a wrong value of the track or the
/// wheelbase). The turn errs to one side in proportion to the speed (`curvature`: a steering that
/// is not straight, wheels of unequal size).
#pragma once

#include <Eigen/Core>

#include <cmath>

#include "../types/pose.h"

namespace localization {

/// Where each quantity stands in the state.
enum Index : unsigned char {
  kX,          ///< m
  kY,          ///< m
  kHeading,    ///< rad, anticlockwise from x
  kSpeed,      ///< m/s, forward
  kTurn,       ///< rad/s, anticlockwise
  kGyroBias,   ///< rad/s, that the gyroscope measures too much
  kScale,      ///< share of the speed that the wheels measure too much
  kTurnScale,  ///< share of the turn rate that the wheels measure too much
  kCurvature,  ///< rad/m, that the wheels measure too much
  kStates,
};

template <int N>
using Column = Eigen::Matrix<double, N, 1>;
template <int N>
using Rows = Eigen::Matrix<double, N, kStates>;
using State = Column<kStates>;
using Matrix = Rows<kStates>;

/// A function of the state, and its derivative there.
template <int N>
struct Model {
  Column<N> value;
  Rows<N> jacobian;
};

/// Speeds stay as they are for `dt` seconds, along the chord. [rt]
inline Model<kStates> moved(const State& state, double dt) {
  const double middle = state[kHeading] + state[kTurn] * dt / 2.0;
  const double cosine = std::cos(middle);
  const double sine = std::sin(middle);
  const double way = state[kSpeed] * dt;
  Model<kStates> model{state, Matrix::Identity()};
  model.value[kX] += way * cosine;
  model.value[kY] += way * sine;
  model.value[kHeading] = rover::wrap(state[kHeading] + state[kTurn] * dt);
  model.jacobian.row(kX).segment<3>(kHeading) << -way * sine, dt * cosine, -way * dt * sine / 2.0;
  model.jacobian.row(kY).segment<3>(kHeading) << way * cosine, dt * sine, way * dt * cosine / 2.0;
  model.jacobian(kHeading, kTurn) = dt;
  return model;
}

/// The expected measurement of the wheels: speed and turn rate. [rt]
inline Model<2> seen_by_wheels(const State& state) {
  Model<2> model{{(1.0 + state[kScale]) * state[kSpeed],
                  (1.0 + state[kTurnScale]) * state[kTurn] + state[kCurvature] * state[kSpeed]},
                 Rows<2>::Zero()};
  model.jacobian(0, kSpeed) = 1.0 + state[kScale];
  model.jacobian(0, kScale) = state[kSpeed];
  model.jacobian(1, kTurn) = 1.0 + state[kTurnScale];
  model.jacobian(1, kTurnScale) = state[kTurn];
  model.jacobian(1, kSpeed) = state[kCurvature];
  model.jacobian(1, kCurvature) = state[kSpeed];
  return model;
}

/// The expected measurement of a gyroscope. [rt]
inline Model<1> seen_by_gyroscope(const State& state) {
  Model<1> model{Column<1>(state[kTurn] + state[kGyroBias]), Rows<1>::Zero()};
  model.jacobian[kTurn] = 1.0;
  model.jacobian[kGyroBias] = 1.0;
  return model;
}

/// The expected measurement of a compass. [rt]
inline Model<1> seen_by_compass(const State& state) {
  Model<1> model{Column<1>(state[kHeading]), Rows<1>::Zero()};
  model.jacobian[kHeading] = 1.0;
  return model;
}

/// The expected satellite measurement of an antenna that is mounted at `mount` in the robot's
/// frame. [rt]
inline Model<2> seen_by_antenna(const State& state, const rover::Point2D& mount) {
  const double cosine = std::cos(state[kHeading]);
  const double sine = std::sin(state[kHeading]);
  const double ahead = cosine * mount.x - sine * mount.y;
  const double aside = sine * mount.x + cosine * mount.y;
  Model<2> model{{state[kX] + ahead, state[kY] + aside}, Rows<2>::Zero()};
  model.jacobian(0, kX) = 1.0;
  model.jacobian(1, kY) = 1.0;
  model.jacobian(0, kHeading) = -aside;
  model.jacobian(1, kHeading) = ahead;
  return model;
}

}  // namespace localization
