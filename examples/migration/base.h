// SPDX-License-Identifier: LGPL-3.0-or-later
/// Component kind "two_wheels/base": a simulated base, which moves as its wheels are commanded and
/// writes its pose, every 10 ms.
#pragma once

#include <cmath>

#include <mauve/plugin.h>

#include "types.h"

namespace two_wheels {

struct BaseShell : mauve::Shell {
  mauve::ReadPort<Wheels> wheels{*this, "wheels"};
  mauve::WritePort<Pose> pose{*this, "pose"};
};

class Base final : public mauve::Core<BaseShell> {
 public:
  mauve::State<Pose> state{*this};

  /// [rt] A driver of a real base would exchange bytes with its device here.
  void update() {
    Wheels wheels = shell().wheels.read();
    if (shell().wheels.status() == mauve::DataStatus::stale) wheels = {};
    const double forward = (wheels.left + wheels.right) / 2;
    const double dt = mauve::to_seconds(mauve::time_step());
    state->heading += (wheels.right - wheels.left) / kTrack * dt;
    state->x += forward * std::cos(state->heading) * dt;
    state->y += forward * std::sin(state->heading) * dt;
    shell().pose.write(*state);
  }
};

}  // namespace two_wheels
