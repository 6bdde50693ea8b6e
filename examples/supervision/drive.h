// SPDX-License-Identifier: LGPL-3.0-or-later
/// Component kind "energy/drive": it turns a wish into a speed within a limit.
#pragma once

#include <mauve/plugin.h>

namespace energy {

struct DriveShell : mauve::Shell {
  mauve::ReadPort<double> wish{*this, "wish"};                       // m/s
  mauve::WritePort<double> speed{*this, "speed", mauve::Safe{0.0}};  // m/s
};

class Drive final : public mauve::Core<DriveShell> {
 public:
  mauve::Property<double> limit{*this, "limit", 1.0, "of the speed", {.unit = "m/s", .min = 0.0}};
  mauve::Stateless stateless{*this};

  /// [rt] every period
  void update();
};

}  // namespace energy
