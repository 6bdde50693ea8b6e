// SPDX-License-Identifier: LGPL-3.0-or-later
/// The obstacles in front of the robot, and the way that it may go on.
#pragma once

#include <cstdint>
#include <tuple>

#include <mauve/property.h>

#include "../types/scan.h"
#include "../types/velocity.h"

namespace safety {

/// How much of a forward speed is let through.
enum class Zone : std::uint8_t {
  clear,  ///< all of it
  slow,   ///< half
  stop,   ///< none; turning and reversing stay allowed
};

/// Distances in metres.
struct Limits {
  double stop_distance = 1.0;
  double slow_distance = 3.0;
  double half_width = 0.35;  ///< of the corridor that the robot sweeps
  double hysteresis = 0.1;   ///< a zone is left only when the way is free by this share more

  static auto parameters() {
    using mauve::parameter;
    return std::tuple{
        parameter("stop_distance", &Limits::stop_distance, "no forward speed nearer than",
                  {.unit = "m", .min = 0.0, .max = 50.0}),
        parameter("slow_distance", &Limits::slow_distance, "half speed nearer than",
                  {.unit = "m", .min = 0.0, .max = 50.0}),
        parameter("half_width", &Limits::half_width, "of the corridor that is watched",
                  {.unit = "m", .min = 0.01, .max = 10.0}),
        parameter("hysteresis", &Limits::hysteresis, "share beyond which a zone is left",
                  {.min = 0.0, .max = 1.0})};
  }
};

/// Range of the nearest return in the corridor ahead; range_max when there is none. [rt]
[[nodiscard]] double free_way(const rover::LaserScan& scan, double half_width);

/// Is the scan without information about the way? It is when no beam is a return, and no beam
/// looked as far as range_max and found nothing. An empty scan, or one of error codes only, comes
/// from a scanner that is covered, dazzled or broken. So is a scan whose geometry is not a number.
/// [rt]
[[nodiscard]] bool blind(const rover::LaserScan& scan);

/// The zone that follows `before` with that much free way. [rt]
[[nodiscard]] Zone next_zone(Zone before, double free_way, const Limits& limits);

/// The command that is safe in the zone; one that is not a number stands still. [rt]
[[nodiscard]] rover::Velocity limited(const rover::Velocity& command, Zone zone);

}  // namespace safety
