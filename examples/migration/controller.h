// SPDX-License-Identifier: LGPL-3.0-or-later
/// Component kind "two_wheels/controller": it reads the pose and commands both wheels, every 10 ms.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include <mauve/plugin.h>

#include "types.h"

namespace two_wheels {

struct ControllerShell : mauve::Shell {
  mauve::ReadPort<Pose> pose{*this, "pose"};
  mauve::WritePort<Wheels> wheels{*this, "wheels", mauve::Safe{Wheels{}}};
};

/// The contract: the state machine calls update(), and cores of one contract replace one another.
class Controller : public mauve::Core<ControllerShell> {
 public:
  using Contract = Controller;
  static constexpr const char* contract = "two_wheels/controller/1";

  mauve::State<Wheels> command{*this};  // survives a swap, so that no wheel jumps
  virtual void update() = 0;            // [rt] every 10 ms

 protected:
  static constexpr double kAcceleration = 2.0;  // m/s2, of a wheel at most

  void give(const Wheels& wanted) {
    const double step = kAcceleration * mauve::to_seconds(mauve::time_step());
    command->left = std::clamp(wanted.left, command->left - step, command->left + step);
    command->right = std::clamp(wanted.right, command->right - step, command->right + step);
    shell().wheels.write(*command);
  }
};

/// Drives to a goal, and stands while the pose is not known.
class GoTo final : public Controller {
 public:
  mauve::Property<double> goal_x{*this, "goal_x", 2.0, "where to drive", {.unit = "m"}};
  mauve::Property<double> goal_y{*this, "goal_y", 1.0, "where to drive", {.unit = "m"}};
  mauve::Property<double> gain{
      *this, "gain", 1.0, "speed per distance", {.unit = "1/s", .min = 0.1, .max = 5.0}};
  mauve::Property<double> speed{
      *this, "speed", 0.5, "of a wheel, at most", {.unit = "m/s", .min = 0.0, .max = 1.0}};

  void update() override {
    const Pose pose = shell().pose.read();
    const mauve::DataStatus status = shell().pose.status();
    if (!has_value(status) || status == mauve::DataStatus::stale) return give({});
    const double dx = goal_x - pose.x;
    const double dy = goal_y - pose.y;
    const double distance = std::hypot(dx, dy);
    if (distance < 0.05) return give({});
    const double error = std::remainder(std::atan2(dy, dx) - pose.heading, 2 * std::numbers::pi);
    const double turn = std::clamp(gain * error * kTrack, -0.5 * speed, 0.5 * speed);
    const double wanted = gain * distance * std::max(0.0, std::cos(error));
    const double forward = std::min(wanted, speed - std::abs(turn));
    give({forward - turn, forward + turn});
  }
};

/// The fallback core: it brings the robot to a stand.
class Stop final : public Controller {
  void update() override { give({}); }
};

}  // namespace two_wheels
