// SPDX-License-Identifier: LGPL-3.0-or-later
/// The time that a simulated base drives on for in one job.
#pragma once

#include <algorithm>
#include <cmath>

#include <mauve/job.h>
#include <mauve/time.h>

namespace drivers {

/// Seconds of `step` for each period since the job before. A base drives on while the machine
/// stands still: if it stood too, the estimate, whose clock goes on, would run ahead of it. At most
/// half a second, since a driver begins a base anew that was silent for so long. [rt]
inline double simulated_time(mauve::Duration step) {
  constexpr double kMost = 0.5;
  const double one = mauve::to_seconds(step);
  const double periods = std::round(mauve::to_seconds(mauve::time_step()) / one);
  return std::max(one, std::min(kMost, periods * one));
}

}  // namespace drivers
