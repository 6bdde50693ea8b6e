// SPDX-License-Identifier: LGPL-3.0-or-later
/// Component kind "water_tank/filler": it fills a tank to a level, and calls the services of the
/// tank.
#pragma once

#include <mauve/plugin.h>

namespace water_tank {

struct FillerShell : mauve::Shell {
  mauve::ReadPort<double> level{*this, "level"};  // m
  /// The safe value closes the valve when the component stops or fails.
  mauve::WritePort<double> valve{*this, "valve", mauve::Safe{0.0}};
  mauve::CallPort<double(double)> time_to{*this, "time_to"};
};

class Filler final : public mauve::Core<FillerShell> {
 public:
  mauve::Property<double> target{
      *this, "target", 1.0, "level to fill to", {.unit = "m", .min = 0.0}};
  mauve::Observable<double> remaining{*this, "remaining", -1.0, "until the target is reached", "s"};
  mauve::Stateless stateless{*this};  // nothing to hand over to the next core

  /// [rt] every period
  void update() {
    const double level = shell().level.read();
    const bool known = has_value(shell().level.status());
    shell().valve.write(known && level < target ? 1.0 : 0.0);
    // The answer is empty when the port is not connected, or the tank is busy for too long.
    remaining = shell().time_to(target).value_or(-1.0);
  }
};

}  // namespace water_tank
