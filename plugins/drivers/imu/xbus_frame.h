// SPDX-License-Identifier: LGPL-3.0-or-later
/// Xbus, the protocol of Xsens MTi inertial units: 0xFA 0xFF, message id, length, data, and a byte
/// that makes the sum of all after 0xFA zero. Source: Xsens, MT Low-Level Communication Protocol
/// Documentation, chapter "Messages".
#pragma once

#include "../serial/binary_frame.h"

namespace drivers {

/// Messages of extended length (more than 254 bytes) are none that a unit sends all the time: they
/// count as damaged.
struct XbusFormat {
  static constexpr std::size_t kHeader = 4;
  static constexpr std::size_t kAround = 5;  ///< header and checksum
  static constexpr std::size_t kLongest = 254 + kAround;

  static std::size_t size(Bytes begun);
  static bool intact(Bytes frame);
};

/// The line of a unit. All of it is [rt].
class XbusStream {
 public:
  enum class Event : std::uint8_t {
    none,   ///< all is looked at: push() the next byte
    frame,  ///< undamaged: see frame()
    bad,    ///< something was damaged
  };

  /// Only after next() returned `none`.
  void push(char byte) { frames_.push(static_cast<std::uint8_t>(byte)); }
  Event next();
  /// The whole frame; until the next call of next().
  [[nodiscard]] Bytes frame() const { return frames_.frame(); }
  /// Something has begun and is not complete yet.
  [[nodiscard]] bool in_frame() const { return frames_.in_frame(); }
  /// The rest of it will not come.
  void drop_begun() { frames_.drop_begun(); }

 private:
  BinaryFrames<XbusFormat> frames_;
};

/// The payload of a frame.
[[nodiscard]] constexpr Bytes xbus_data(Bytes frame) {
  return frame.subspan(XbusFormat::kHeader, frame.size() - XbusFormat::kAround);
}

/// Puts header and checksum around the data that is already in its place of `frame`.
void xbus_seal(std::span<std::uint8_t> frame, std::uint8_t message);

}  // namespace drivers
