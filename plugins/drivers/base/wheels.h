// SPDX-License-Identifier: LGPL-3.0-or-later
/// A base on two driven wheels: speeds to wheels, and counts of their encoders to a pose.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>

#include <mauve/property.h>

#include "../../types/pose.h"
#include "../../types/velocity.h"

namespace drivers {

/// Metres. The default is a Create 2.
struct Wheels {
  double diameter = 0.072;
  double base = 0.235;     ///< between the two wheels
  double counts = 508.8;   ///< of an encoder in one turn of its wheel
  double speed_max = 0.5;  ///< of a wheel, m/s

  /// Metres in one count. [any]
  [[nodiscard]] double step() const;

  static auto parameters() {
    using mauve::parameter;
    return std::tuple{parameter(/*of a wheel*/ "wheel_diameter", &Wheels::diameter, "",
                                {.unit = "m", .min = 0.01, .max = 1.0}),
                      parameter(/*of wheels*/ "wheel_base", &Wheels::base, "between them",
                                {.unit = "m", .min = 0.05, .max = 2.0}),
                      parameter("counts", &Wheels::counts, "of an encoder in a turn",
                                {.min = 1.0, .max = 10'000.0}),
                      parameter("speed_max", &Wheels::speed_max, "of a wheel",
                                {.unit = "m/s", .min = 0.0, .max = 0.5})};
  }
};

/// m/s.
struct WheelSpeeds {
  double left = 0.0;
  double right = 0.0;
};

/// Both speeds are reduced alike when one would be too fast, so that the robot stays on its curve.
/// Both wheels stand still when a speed is not a number. [rt]
[[nodiscard]] WheelSpeeds wheel_speeds(const rover::Velocity& velocity, const Wheels& wheels);
/// The way back. [rt]
[[nodiscard]] rover::Velocity velocity_of(const WheelSpeeds& speeds, const Wheels& wheels);

/// Adds up encoder counts of 16 bits, which wrap. Speeds are means over the last few reports. All
/// of it is [rt].
class WheelOdometry {
 public:
  enum class Step : std::uint8_t {
    first,  ///< something to count from
    moved,  ///< the pose goes on
    jump,   ///< farther than the wheels can have turned, or too long ago: counted from here anew
  };

  /// The counts now, `seconds` after those before.
  Step advance(std::uint16_t left, std::uint16_t right, double seconds, const Wheels& wheels);
  /// Its time is not set.
  [[nodiscard]] const rover::Odometry& odometry() const { return odometry_; }
  /// How long ago the speeds were so, s.
  [[nodiscard]] double lag() const { return span_ / 2.0; }

 private:
  struct Travel {
    double left = 0.0;
    double right = 0.0;
    double seconds = 0.0;
  };
  void take(const Travel& travel, const Wheels& wheels);

  static constexpr std::size_t kWindow = 4;
  static constexpr double kLongest = 10.0;  // s; later the counts may have wrapped unseen

  rover::Odometry odometry_;
  std::array<Travel, kWindow> recent_{};
  std::size_t next_ = 0;
  double span_ = 0.0;
  std::uint16_t left_ = 0;
  std::uint16_t right_ = 0;
  bool begun_ = false;
};

}  // namespace drivers
