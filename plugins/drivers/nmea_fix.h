// SPDX-License-Identifier: LGPL-3.0-or-later
/// From NMEA sentences to gnss_fix/1: one fix for each GGA, its dimensions from the last GSA.
#pragma once

#include <cstdint>
#include <string_view>

#include "../types/gnss.h"

namespace drivers {

/// Keeps what one sentence tells about the next. All of it is [rt].
class FixReader {
 public:
  enum class Event : std::uint8_t {
    ignored,    ///< a sentence that says nothing we want
    fix,        ///< an epoch: see fix()
    malformed,  ///< right checksum, but fields that cannot be
  };

  /// `frame` is the text between `$` and `*`.
  Event read(std::string_view frame);
  /// The fix of the last epoch.
  [[nodiscard]] const rover::GnssFix& fix() const { return fix_; }

 private:
  rover::GnssFix fix_;
  int dimensions_ = 0;  // best GSA since the last GGA: 0 none heard, 1 no fix, 2, 3
};

}  // namespace drivers
