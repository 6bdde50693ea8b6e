// SPDX-License-Identifier: LGPL-3.0-or-later
/// Resource kind "water_tank/tank": a simulated tank of water with an inlet valve. It has no
/// thread: its methods run in the thread of the caller, one caller at a time.
#pragma once

#include <algorithm>

#include <mauve/plugin.h>

namespace water_tank {

struct Water {
  double level = 0.0;             ///< m
  double opening = 0.0;           ///< of the valve, 0 to 1
  mauve::Instant updated_at = 0;  ///< ns, monotonic clock

  static constexpr std::string_view type_name = "water_tank_water/1";
  static constexpr auto fields() {
    return std::tuple{mauve::field("level", &Water::level, "m"),
                      mauve::field("opening", &Water::opening),
                      mauve::field("updated_at", &Water::updated_at, "ns")};
  }
};

class Tank final : public mauve::Core<mauve::EmptyShell> {
 public:
  mauve::Property<double> inflow{*this,
                                 "inflow",
                                 0.1,
                                 "rise of the level with an open valve",
                                 {.unit = "m/s", .min = 0.0, .max = 10.0}};
  mauve::State<Water> state{*this};

  /// [rt] read service "level", m
  double level() {
    flow();
    return state->level;
  }
  /// [rt] write service "valve", 0 to 1
  void set_valve(const double& opening) {
    flow();  // until now with the old opening
    state->opening = std::clamp(opening, 0.0, 1.0);
  }
  /// [rt] call service "time_to", s until the level is reached; negative: never
  double time_to(double level) {
    flow();
    const double missing = level - state->level;
    const double rate = inflow * state->opening;
    return missing <= 0.0 ? 0.0 : rate > 0.0 ? missing / rate : -1.0;
  }
  /// [rt] event service "drain"
  void drain() { *state = {0.0, 0.0, mauve::job_time()}; }

 private:
  /// Advances the simulation to the start of the job that calls.
  void flow() {
    const mauve::Instant now = mauve::job_time();
    if (state->updated_at != 0) {
      state->level += inflow * state->opening * mauve::to_seconds(now - state->updated_at);
    }
    state->updated_at = now;
  }
};

struct Services : mauve::Interface<Tank> {
  mauve::ReadService<double> level{*this, "level", &Tank::level};
  /// One port at most may write here: the valve moves something.
  mauve::WriteService<double> valve{*this, "valve", &Tank::set_valve, mauve::Writers::one};
  mauve::CallService<double(double)> time_to{*this, "time_to", &Tank::time_to};
  mauve::EventService<> drain{*this, "drain", &Tank::drain};
};

}  // namespace water_tank
