// SPDX-License-Identifier: LGPL-3.0-or-later
/// The potential field as pure functions; the plugin around it is potential_field.cpp.
///
/// The equations are a reconstruction. They have the properties that the abstract of Guerra,
/// Efimov, Zheng, Perruquetti (Control Engineering Practice 55, 2016) states. The goal attracts,
/// obstacle centres are repelling equilibria, saddles sit on the obstacle borders, and a bounded
/// extra input leaves them.
#pragma once

#include <tuple>

#include <mauve/property.h>

#include "guidance.h"
#include "obstacles.h"

namespace guidance {

/// Distances are in metres, as in the published listing. repaired() makes any values usable.
struct FieldParameters {
  double nu = 0.2;                 ///< inside this distance to the goal the pull fades linearly
  double psi = 1.0;                ///< beyond it the pull is one
  double obstacle_distance = 0.8;  ///< d, an obstacle pushes inside it
  double safety_distance = 0.6;    ///< r_s, nearest approach of the robot's centre
  double gain = 1.0;               ///< scales the pull
  double escape = 0.6;             ///< strength of the input that leaves saddles
  double speed = 0.6;              ///< m/s
  HeadingLaw heading;

  static auto parameters() {
    using P = FieldParameters;
    using mauve::parameter;
    return std::tuple{
        parameter("gain", &P::gain, "strength of the pull", {.min = 0.01, .max = 10.0}),
        parameter("nu", &P::nu, "inside it the pull fades", {.unit = "m", .min = 0.0}),
        parameter("psi", &P::psi, "beyond it the pull is full", {.unit = "m", .min = 0.0}),
        parameter("obstacle_distance", &P::obstacle_distance, "the push starts here",
                  {.unit = "m", .min = 0.1, .max = 10.0}),
        parameter("safety_distance", &P::safety_distance, "nearest approach",
                  {.unit = "m", .min = 0.1, .max = 10.0}),
        parameter("escape", &P::escape, "sideways input that leaves a dead end",
                  {.min = 0.0, .max = 1.0}),
        parameter("speed", &P::speed, "at most", {.unit = "m/s", .min = 0.0, .max = 2.0})};
  }
};

/// The parameters, changed where needed so that d >= 1.25 r_s, d / sqrt(3) <= r_s (else the robot
/// could pass the barrier) and psi >= nu > 0. The published d = r_s becomes d = 1.25 r_s. [any]
[[nodiscard]] FieldParameters repaired(FieldParameters parameters);

/// L(s): 1 up to nu, 0 from psi, a cubic between them; a step when nu = psi. [any]
[[nodiscard]] double blend(double distance, double nu, double psi);

/// Strength of the pull at that distance from the goal, 0..1. [any]
[[nodiscard]] double attraction(double distance, const FieldParameters& parameters);

/// Strength of the push at that distance from an obstacle; equals the full pull at r_s. [any]
[[nodiscard]] double repulsion(double distance, const FieldParameters& parameters);

/// The velocity wanted at this pose, before slew limits; keeps its choice of side in `state`. [rt]
[[nodiscard]] Velocity follow_field(const FieldParameters& parameters, const Pose2D& pose,
                                    const Obstacles& obstacles, Guidance& state);

}  // namespace guidance
