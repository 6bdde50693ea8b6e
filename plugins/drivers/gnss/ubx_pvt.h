// SPDX-License-Identifier: LGPL-3.0-or-later
/// UBX-NAV-PVT, one epoch of a u-blox receiver, as gnss_fix/1 and back. Source: as ubx_frame.h,
/// chapter "UBX-NAV-PVT".
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "../../types/gnss.h"
#include "../serial/binary_frame.h"

namespace drivers {

/// Is this frame a NAV-PVT?
[[nodiscard]] bool is_pvt(Bytes frame);

/// The fix in the message; nothing when its fields cannot be. 84 bytes of payload (protocol 14) or
/// 92. `hdop` is the receiver's PDOP, the only dilution in the message: never better than the
/// horizontal one.
[[nodiscard]] std::optional<rover::GnssFix> read_pvt(Bytes frame);

/// Metres from mean sea level to the ellipsoid, of a message that read_pvt() understood.
[[nodiscard]] double pvt_separation(Bytes frame);

/// The frame of one epoch, 92 bytes of payload, for the simulated receiver. [rt]
[[nodiscard]] std::array<std::uint8_t, 100> write_pvt(const rover::GnssFix& fix);

}  // namespace drivers
