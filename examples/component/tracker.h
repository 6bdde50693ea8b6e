// SPDX-License-Identifier: LGPL-3.0-or-later
/// Component kind "tracker/filter": an alpha-beta filter. It reads noisy positions and writes
/// position and speed, every 10 ms.
#pragma once

#include <mauve/plugin.h>

namespace tracker {

/// The data type that travels on the port. It has a fixed size and no pointer.
struct Motion {
  double position = 0.0;  ///< m
  double speed = 0.0;     ///< m/s

  /// Name and fields of the type: JSON, recordings and the check of the layout come from them.
  static constexpr std::string_view type_name = "tracker_motion/1";
  static constexpr auto fields() {
    return std::tuple{mauve::field("position", &Motion::position, "m"),
                      mauve::field("speed", &Motion::speed, "m/s")};
  }
};

struct Shell : mauve::Shell {
  mauve::ReadPort<double> measured{*this, "measured"};  // m
  mauve::WritePort<Motion> motion{*this, "motion"};
};

class Filter final : public mauve::Core<Shell> {
 public:
  mauve::Property<double> alpha{*this,
                                "alpha",
                                0.5,
                                "share of the error that corrects the position",
                                {.min = 0.0, .max = 1.0}};
  mauve::Property<double> beta{
      *this, "beta", 0.1, "share of the error that corrects the speed", {.min = 0.0, .max = 2.0}};
  /// Survives a change of the core: the next build continues with the same estimate.
  mauve::State<Motion> state{*this};
  mauve::Observable<int> without_data{*this, "without_data", 0, "jobs without a new measurement"};

  /// [rt] every period
  void update() {
    const double dt = mauve::to_seconds(mauve::time_step());
    state->position += state->speed * dt;
    const double measured = shell().measured.read();
    if (shell().measured.status() == mauve::DataStatus::new_data) {
      const double error = measured - state->position;
      state->position += alpha * error;
      state->speed += beta * error / dt;
    } else {
      ++without_data;
    }
    shell().motion.write(*state);
  }
};

}  // namespace tracker
