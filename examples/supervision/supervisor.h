// SPDX-License-Identifier: LGPL-3.0-or-later
/// Component kind "energy/supervisor": it watches the battery, and requests transactions.
#pragma once

#include <mauve/plugin.h>

namespace energy {

struct SupervisorShell : mauve::Shell {
  mauve::ReadPort<double> charge{*this, "charge"};  // 0 to 1
};

class Supervisor final : public mauve::Core<SupervisorShell> {
 public:
  mauve::Property<double> low{*this, "low", 0.2, "the robot saves below", {.min = 0.0, .max = 1.0}};
  mauve::Property<double> high{*this, "high", 0.5, "it stops to save", {.min = 0.0, .max = 1.0}};
  mauve::Observable<bool> saves{*this, "saves", false, "the robot saves energy"};
  mauve::Stateless stateless{*this};

  /// [rt] every period
  void update();

 private:
  mauve::Status on_configure() override;
};

}  // namespace energy
