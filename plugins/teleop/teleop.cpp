// SPDX-License-Identifier: LGPL-3.0-or-later
/// Resource kind "teleop/teleop": turns the state of a joystick into a velocity, at the moment it
/// is written to service `joystick`, and writes that to port `velocity`. When the joystick is let
/// go or goes away, it writes one standstill and then nothing, so that a `teleop/priority` behind
/// it gives the robot back. Example: "teleop": { "type": "teleop/teleop", "ports": { "velocity":
/// "priority.teleop" } }
#include <cstdint>

#include "parts.h"
#include "steering.h"

namespace teleop {

/// The state that survives a change.
struct TeleopState {
  bool steering = false;

  static constexpr std::string_view type_name = "teleop_state/1";
  static constexpr auto fields() {
    return std::tuple{mauve::field("steering", &TeleopState::steering)};
  }
};

namespace {

using rover::Joystick;
using rover::Velocity;

struct TeleopShell : mauve::Shell {
  mauve::WritePort<Velocity> velocity{*this, "velocity", mauve::Safe{Velocity{}}};
};

class Teleop final : public mauve::Core<TeleopShell> {
 public:
  void joystick(const Joystick& now) {
    const std::optional<Velocity> wanted = steer(now, controls);
    if (wanted) {
      state->steering = true;
      ++commands;
      shell().velocity.write(*wanted);
    } else if (state->steering) {
      // One that was not delivered is sent again: nothing must be left moving.
      state->steering = !shell().velocity.write(Velocity{});
    }
    steering = state->steering;
  }

 private:
  mauve::State<TeleopState> state{*this};
  mauve::Parameters<Controls> controls{*this};
  mauve::Observable<bool> steering{*this, "steering", false, "somebody steers"};
  mauve::Observable<std::uint64_t> commands{*this, "commands", 0, "velocities written"};
};

struct TeleopInterface : mauve::Interface<Teleop> {
  mauve::WriteService<Joystick> joystick{*this, "joystick", &Teleop::joystick};
};

}  // namespace

void declare_teleop(mauve::Plugin& plugin) {
  plugin.resource<TeleopShell, Teleop, TeleopInterface>("teleop");
}

}  // namespace teleop
