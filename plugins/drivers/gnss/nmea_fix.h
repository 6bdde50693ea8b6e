// SPDX-License-Identifier: LGPL-3.0-or-later
/// From NMEA sentences to gnss_fix/1: one fix for each GGA, its dimensions from the last GSA, and
/// its confirmation by RMC, GLL and GSA.
#pragma once

#include <cstdint>
#include <string_view>

#include "../../types/gnss.h"
#include "fix_gate.h"

namespace drivers {

/// Time and place as RMC or GLL have them.
struct Witness {
  double time = 0.0;
  double latitude = 0.0;
  double longitude = 0.0;
  double grain = 0.0;  // deg, of its last digit; 0: no place
};

/// Keeps the values of one sentence that matter for the next. All of it is [rt].
class FixReader {
 public:
  enum class Event : std::uint8_t {
    ignored,    ///< a sentence without anything we use
    fix,        ///< an epoch: see fix()
    malformed,  ///< right checksum, but fields that cannot be
  };

  /// `frame` is the text between `$` and `*`.
  Event read(std::string_view frame);
  /// The fix of the last epoch, and further knowledge of it.
  [[nodiscard]] const rover::GnssFix& fix() const { return fix_; }
  [[nodiscard]] const FixContext& context() const { return context_; }

 private:
  Event read_gga(std::string_view frame);
  void hear(const Witness& said, Witness& kept);
  void compare(bool same);

  rover::GnssFix fix_;
  FixContext context_;
  Witness rmc_;
  Witness gll_;
  double grain_ = 0.0;     // deg, of the last digit of the position in GGA
  double dilution_ = 0.0;  // of the last GSA
  int dimensions_ = 0;     // best GSA since the last GGA: 0 none heard, 1 no fix, 2, 3
  int agreed_ = 0;         // how well the sentences of this receiver agree
};

}  // namespace drivers
