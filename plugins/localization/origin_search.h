// SPDX-License-Identifier: LGPL-3.0-or-later
/// Looks for fixes that agree, of which the first can be the origin of the local frame.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "utm.h"

namespace localization {

/// Fixes agree that a vehicle can have made one after another. All of it is [rt].
class OriginSearch {
 public:
  static constexpr int kAgree = 3;           ///< that many in a row
  static constexpr double kFastest = 100.0;  ///< m/s
  static constexpr double kNoise = 10.0;     ///< m a receiver may jump in no time

  enum class Found : std::uint8_t {
    none_on_earth,  ///< the fix has no place in UTM
    nothing,        ///< not yet
    origin,         ///< see first()
  };

  /// A fix that came at `now`, s of a clock that never jumps.
  Found look(const Geographic& fix, double now) {
    if (!Utm::zone_of(fix)) return Found::none_on_earth;
    const bool agrees =
        count_ > 0 && metres(last_, fix) <= kNoise + kFastest * std::abs(now - when_);
    if (!agrees) {
      count_ = 0;
      first_ = fix;
    }
    last_ = fix;
    when_ = now;
    return ++count_ >= kAgree ? Found::origin : Found::nothing;
  }
  /// The first of those that agree.
  [[nodiscard]] const Geographic& first() const { return first_; }

 private:
  /// Good for jumps, not for surveys.
  static double metres(const Geographic& a, const Geographic& b) {
    constexpr double kRadians = std::numbers::pi / 180.0;
    constexpr double kRadius = 6'371'000.0;
    const double east = std::remainder(b.longitude - a.longitude, 360.0);
    return kRadius * kRadians *
           std::hypot(b.latitude - a.latitude, east * std::cos(a.latitude * kRadians));
  }

  Geographic first_{};
  Geographic last_{};
  double when_ = 0.0;  // s, of the last fix
  int count_ = 0;      // in a row that agree
};

}  // namespace localization
