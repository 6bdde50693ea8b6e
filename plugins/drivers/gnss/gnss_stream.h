// SPDX-License-Identifier: LGPL-3.0-or-later
/// The line of a receiver that speaks NMEA, UBX or both: sentences and messages, in the order they
/// came.
#pragma once

#include <cstdint>
#include <string_view>

#include "nmea_frame.h"
#include "ubx_frame.h"

namespace drivers {

/// Bytes of no UBX message are searched for NMEA, so neither is found inside the other. A damaged
/// message is one with a wrong checksum whose kind this line has proven, or that is a NAV-PVT.
/// Others are bytes of something else. All of it is [rt].
class GnssStream {
 public:
  enum class Event : std::uint8_t {
    none,      ///< all is looked at: push() the next byte
    sentence,  ///< undamaged NMEA: see sentence()
    message,   ///< undamaged UBX: see message()
    bad,       ///< something was damaged
  };

  /// Only after next() returned `none`.
  void push(char byte) { messages_.push(static_cast<std::uint8_t>(byte)); }
  Event next();

  /// Text between `$` and `*`; until the next call of next().
  [[nodiscard]] std::string_view sentence() const { return sentences_.frame(); }
  /// The whole frame; until the next call of next().
  [[nodiscard]] Bytes message() const { return messages_.frame(); }

  /// Damaged ones so far. It wraps.
  [[nodiscard]] std::uint32_t bad() const { return bad_; }
  /// Something has begun and is not complete yet.
  [[nodiscard]] bool in_frame() const { return messages_.in_frame() || sentences_.in_frame(); }
  /// The rest of it will not come.
  void drop_begun();

 private:
  Event find();
  [[nodiscard]] bool damaged();

  UbxFrames messages_;
  FrameReader sentences_;
  Proven<std::uint16_t, 32> proven_;  // kinds of messages
  std::uint32_t bad_ = 0;
  bool dropped_ = false;
};

}  // namespace drivers
