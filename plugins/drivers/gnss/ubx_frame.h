// SPDX-License-Identifier: LGPL-3.0-or-later
/// UBX, the binary protocol of u-blox receivers: 0xB5 0x62, class, id, length (little endian),
/// payload, two bytes of checksum. Source: u-blox M8 Receiver Description and Protocol
/// Specification, UBX-13003221, chapter "UBX Protocol".
#pragma once

#include "../serial/binary_frame.h"

namespace drivers {

struct UbxFormat {
  static constexpr std::size_t kHeader = 6;
  static constexpr std::size_t kAround = 8;  ///< header and checksum
  /// A longer message (NAV-SIG of many signals) has nothing that is read here. Its bytes are none
  /// of a frame: to wait for as many as a damaged length says would hold up all that is in them.
  static constexpr std::size_t kLongest = 1024;

  static std::size_t size(Bytes begun);
  static bool intact(Bytes frame);
};

using UbxFrames = BinaryFrames<UbxFormat>;

/// The payload of a frame.
[[nodiscard]] constexpr Bytes ubx_payload(Bytes frame) {
  return frame.subspan(UbxFormat::kHeader, frame.size() - UbxFormat::kAround);
}

/// Class and id, 0xCCII.
[[nodiscard]] constexpr std::uint16_t ubx_name(Bytes frame) {
  return static_cast<std::uint16_t>(frame[2] * 256 + frame[3]);
}

/// Puts sync, class, id, length and checksum around the payload that is already in its place of
/// `frame`.
void ubx_seal(std::span<std::uint8_t> frame, std::uint8_t group, std::uint8_t id);

}  // namespace drivers
