// SPDX-License-Identifier: LGPL-3.0-or-later
/// The state of the wheel counter in its three revisions. Each revision keeps its description for
/// as long as a core converts from it.
#pragma once

#include <cstdint>

#include <mauve/type.h>

namespace wheel {

/// Revision 1 counts the ticks of the encoder. The counter is too small for a long drive.
struct CountV1 {
  std::int32_t ticks = 0;

  static constexpr std::string_view type_name = "wheel_count/1";
  static constexpr auto fields() { return std::tuple{mauve::field("ticks", &CountV1::ticks)}; }
};

/// Revision 2 has a larger counter, and the speed.
struct CountV2 {
  std::int64_t ticks = 0;
  double speed = 0.0;  ///< ticks/s

  static constexpr std::string_view type_name = "wheel_count/2";
  static constexpr auto fields() {
    return std::tuple{mauve::field("ticks", &CountV2::ticks),
                      mauve::field("speed", &CountV2::speed, "1/s")};
  }
};

/// Revision 3 has units of the world in place of ticks.
struct CountV3 {
  double distance = 0.0;  ///< m
  double speed = 0.0;     ///< m/s

  static constexpr std::string_view type_name = "wheel_count/3";
  static constexpr auto fields() {
    return std::tuple{mauve::field("distance", &CountV3::distance, "m"),
                      mauve::field("speed", &CountV3::speed, "m/s")};
  }
};

inline constexpr double kTick = 0.001;  // m

}  // namespace wheel
