// SPDX-License-Identifier: LGPL-3.0-or-later
/// The knowledge of the filter, and its parameters.
#pragma once

#include <array>
#include <cstdint>
#include <tuple>

#include <mauve/property.h>

#include "../types/imu.h"
#include "../types/motion.h"
#include "models.h"

namespace localization {

/// Noises are deviations; the unit of those that grow with time or way shows that.
struct Parameters {
  double acceleration = 1.0;       ///< m/s^2/sqrt(Hz), unknown to the filter
  double turn_acceleration = 1.0;  ///< rad/s^2/sqrt(Hz)
  double slip = 0.02;              ///< m/sqrt(m), of the place
  double heading_slip = 0.005;     ///< rad/sqrt(m)
  double gyro_bias_walk = 1e-4;    ///< rad/s/sqrt(s)
  double scale_walk = 1e-4;        ///< 1/sqrt(s), of both scales
  double curvature_walk = 1e-5;    ///< rad/m/sqrt(s)

  double twist_linear = 0.05;   ///< m/s
  double twist_angular = 0.05;  ///< rad/s
  double gyroscope = 0.01;      ///< rad/s
  double compass = 0.05;        ///< rad
  double position = 2.5;        ///< m, of poses without one of their own
  rover::Point2D antenna;       ///< m, in the robot's frame

  double gyro_bias = 0.02;   ///< rad/s, at first
  double scale = 0.02;       ///< at first; 0: the wheels are right
  double turn_scale = 0.05;  ///< at first; 0: the wheels are right
  double curvature = 0.003;  ///< rad/m, at first; 0: the wheels are right

  double gate = 1.0;            ///< times the chi-square limits of 99 %; 0: no gate
  int reacquire_after = 10;     ///< consistent measurements outside the gate in a row; 0: never
  double align_distance = 1.5;  ///< m, at least, from which the heading is derived

  static auto parameters() {
    using P = Parameters;
    using mauve::parameter;
    return std::tuple{
        parameter("acceleration", &P::acceleration, "unknown",
                  {.unit = "m/s2/sqrt(Hz)", .min = 1e-3, .max = 100.0}),
        parameter("turn_acceleration", &P::turn_acceleration, "unknown",
                  {.unit = "rad/s2/sqrt(Hz)", .min = 1e-3, .max = 100.0}),
        parameter("slip", &P::slip, "of the place", {.unit = "m/sqrt(m)", .min = 0.0, .max = 10.0}),
        parameter("heading_slip", &P::heading_slip, "of the heading",
                  {.unit = "rad/sqrt(m)", .min = 0.0, .max = 1.0}),
        parameter("twist_linear", &P::twist_linear, "deviation of a speed",
                  {.unit = "m/s", .min = 1e-4, .max = 100.0}),
        parameter("twist_angular", &P::twist_angular, "deviation of a turn rate of the wheels",
                  {.unit = "rad/s", .min = 1e-4, .max = 100.0}),
        parameter("gyroscope", &P::gyroscope, "deviation of its turn rate",
                  {.unit = "rad/s", .min = 1e-5, .max = 10.0}),
        parameter("gyro_bias", &P::gyro_bias, "deviation at first",
                  {.unit = "rad/s", .min = 0.0, .max = 1.0}),
        parameter("compass", &P::compass, "deviation of its heading",
                  {.unit = "rad", .min = 1e-4, .max = 3.0}),
        parameter("scale", &P::scale,
                  "deviation of the share that the wheels say too much; 0: they are right",
                  {.min = 0.0, .max = 0.5}),
        parameter("turn_scale", &P::turn_scale, "the same of turn rates", {.min = 0.0, .max = 0.5}),
        parameter("curvature", &P::curvature,
                  "deviation of the turn that the wheels say too much; 0: they are right",
                  {.unit = "rad/m", .min = 0.0, .max = 1.0}),
        parameter("position", &P::position, "deviation of a pose that does not say its own",
                  {.unit = "m", .min = 1e-3, .max = 1e4}),
        parameter("antenna", &P::antenna, "in the robot's frame, m"),
        parameter("gate", &P::gate, "times the chi-square limit of 99 %; 0: everything is believed",
                  {.min = 0.0, .max = 100.0}),
        parameter("reacquire_after", &P::reacquire_after,
                  "measurements outside the gate that agree; 0: never", {.min = 0, .max = 100'000}),
        parameter("align_distance", &P::align_distance,
                  "driven at least before the heading is derived from poses",
                  {.unit = "m", .min = 0.1, .max = 1e3})};
  }
};

/// The share of positions outside the gate is looked at over so many.
inline constexpr int kRecent = 16;

/// Measurements of one kind outside the gate that agree with one another.
struct Rival {
  std::int32_t agreeing = 0;
  double since = 0.0;              ///< s, the first of them
  std::array<double, 2> offset{};  ///< of the last reading from the prediction
};

/// All that the filter knows.
struct Estimate {
  double time = 0.0;  ///< s, of the last measurement
  std::array<double, kStates> mean{};
  std::array<double, kStates * kStates> covariance{};  ///< column by column
  bool begun = false;
  bool placed = false;    ///< x and y count from the origin of the positions
  bool aligned = false;   ///< the heading counts from x
  rover::Point2D anchor;  ///< the position that placed it

  double pose_time = 0.0;     ///< s, of the last position accepted
  double nis = 0.0;           ///< normalised innovation squared of the last position
  std::uint32_t recent = 0;   ///< one bit for each of the last positions, 1: outside the gate
  std::int32_t agreeing = 0;  ///< positions outside the gate that agree with one another
  rover::Point2D offset;      ///< of the last of them from where the filter is
  std::uint64_t accepted = 0;
  std::uint64_t rejected = 0;    ///< positions outside the gate
  std::uint64_t outliers = 0;    ///< other measurements outside the gate
  std::uint64_t reacquired = 0;  ///< times the filter gave in to such
  Rival odd_wheels;
  Rival odd_gyroscope;
  Rival odd_heading;

  /// Larger eigenvalue of the covariance of the place, its root, m. [rt]
  [[nodiscard]] double dispersion() const;
  /// Of the last kRecent positions, outside the gate. [rt]
  [[nodiscard]] int rejected_recently() const;
};

/// Nothing known but the noises. [rt]
[[nodiscard]] Estimate begin(const Parameters& parameters);
/// The robot stands at `start`. [rt]
[[nodiscard]] Estimate begin(const Parameters& parameters, const rover::Pose2D& start,
                             double deviation, double heading_deviation);

}  // namespace localization
