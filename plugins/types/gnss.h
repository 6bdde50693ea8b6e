// SPDX-License-Identifier: LGPL-3.0-or-later
/// The report of a satellite navigation receiver once an epoch: gnss_fix/1.
#pragma once

#include <cstdint>

#include <mauve/type.h>

namespace rover {

/// One epoch. With mode 1 the position is zero and means nothing.
struct GnssFix {
  double time = 0.0;       ///< s of the day, UTC; 0 when the receiver does not know it yet
  double latitude = 0.0;   ///< deg, north positive
  double longitude = 0.0;  ///< deg, east positive
  double altitude = 0.0;   ///< m above mean sea level
  double hdop = 0.0;       ///< horizontal dilution of precision
  std::int32_t mode = 1;   ///< 1 none, 2 two dimensions, 3 three dimensions
  std::int32_t satellites = 0;

  static constexpr std::string_view type_name = "gnss_fix/1";
  static constexpr auto fields() {
    return std::tuple{
        mauve::field("time", &GnssFix::time, "s", "of the day, UTC, as the receiver says"),
        mauve::field("latitude", &GnssFix::latitude, "deg", "north positive"),
        mauve::field("longitude", &GnssFix::longitude, "deg", "east positive"),
        mauve::field("altitude", &GnssFix::altitude, "m", "above mean sea level"),
        mauve::field("mode", &GnssFix::mode, "", "1 none, 2 two dimensions, 3 three dimensions"),
        mauve::field("satellites", &GnssFix::satellites),
        mauve::field("hdop", &GnssFix::hdop)};
  }
};

}  // namespace rover
