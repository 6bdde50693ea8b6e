// SPDX-License-Identifier: LGPL-3.0-or-later
/// NMEA sentences as a receiver would send them, for the simulated one. No heap, no locale.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "../../types/gnss.h"
#include "../../types/velocity.h"

namespace drivers {

/// Text of one epoch: GGA, GSA and RMC with checksums and line ends.
class NmeaWriter {
 public:
  /// Composes the sentences of `fix`; `course` in degrees from north, clockwise. [rt]
  std::string_view compose(const rover::GnssFix& fix, double speed, double course);

 private:
  void begin(std::string_view address);
  void end();
  void text(std::string_view piece);
  void digits(std::size_t number, int width);
  void decimal(double value, int before, int after);
  void position(const rover::GnssFix& fix);
  void time_of_day(double seconds);

  std::array<char, 320> buffer_{};
  std::size_t size_ = 0;
  std::size_t start_ = 0;
};

}  // namespace drivers
