// SPDX-License-Identifier: LGPL-3.0-or-later
/// From sentences and messages of one receiver to its epochs, each once and none that cannot be.
#pragma once

#include <cstdint>
#include <limits>
#include <string_view>

#include "fix_gate.h"
#include "gnss_stream.h"
#include "nmea_fix.h"

namespace drivers {

/// After an understood NAV-PVT, GGA is ignored until no NAV-PVT came for 2 s. So each epoch of a
/// receiver that sends both is reported once, by the message that has all of it in one frame. All
/// of it is [rt].
class GnssReader {
 public:
  static constexpr double kSilence = 2.0;   ///< s without NAV-PVT until GGA is heard again
  static constexpr double kPatience = 0.1;  ///< s more that an epoch is held than twice the last
  static constexpr int kMending = 12;       ///< undamaged frames that make up for a damaged one
  static constexpr int kBad = 24;           ///< a line that lacks more of them is a bad one

  enum class Event : std::uint8_t {
    ignored,      ///< has nothing we use, or the same epoch again
    fix,          ///< an epoch: see fix()
    malformed,    ///< right checksum, but fields that cannot be
    implausible,  ///< an epoch that FixGate refuses
  };

  /// Reads the frame that `stream` just found. `now` in seconds of a clock that never jumps;
  /// `speed_limit` as in FixGate.
  Event read(GnssStream::Event found, const GnssStream& stream, double now, double speed_limit);
  /// The last read() gave the epoch before, which was held: it is to be called again.
  [[nodiscard]] bool unread() const { return sentences_.unread(); }
  /// An epoch whose better sentence or status is overdue; else `ignored`.
  Event overdue(double now, double speed_limit);
  /// The last epoch that came through.
  [[nodiscard]] const rover::GnssFix& fix() const { return fix_; }

 private:
  void suspect(int damaged);
  Event read_sentence(std::string_view sentence, double now);
  Event take(FixReader::Event event, double now);
  Event admit(Event event, double now, double speed_limit);
  Event read_message(Bytes message, double now);

  FixReader sentences_;
  FixGate gate_;
  rover::GnssFix next_;    // read, not through the gate yet
  FixContext context_;     // of that
  std::uint32_t bad_ = 0;  // of the stream, when it was looked at last
  int mending_ = 0;        // undamaged frames that the line lacks
  rover::GnssFix fix_;
  double held_since_ = 0.0;
  double patience_ = 0.5;  // s that an epoch is held at most
  double last_message_ = -std::numeric_limits<double>::infinity();
  double message_time_ = -1.0;  // s of the day, of the epoch in the last message
};

}  // namespace drivers
