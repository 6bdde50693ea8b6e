// SPDX-License-Identifier: LGPL-3.0-or-later
/// The result of a read, and the position of one reader in the values of one service.
#pragma once

#include <cstdint>
#include <string_view>

#include <mauve/time.h>

namespace mauve {

/// Result of a read.
enum class DataStatus : std::uint8_t {
  no_data,    ///< never written, or the port is not connected: the port's default was returned
  old_data,   ///< the value read before
  new_data,   ///< written since the last read
  stale,      ///< older than the port's max_age; the value is delivered
  timed_out,  ///< the resource was busy beyond the caller's bound: the default was returned
  poisoned,   ///< a caller crashed inside the resource, see ResourceLock::poison: the default was
              ///< returned
};

[[nodiscard]] std::string_view to_string(DataStatus status);  ///< "no_data", ...

/// Did the read deliver a value?
[[nodiscard]] constexpr bool has_value(DataStatus status) {
  return status == DataStatus::old_data || status == DataStatus::new_data ||
         status == DataStatus::stale;
}

/// The position of one reader in the values of one service.
struct Cursor {
  unsigned slot = 0;       ///< reader slot of a wait-free exchange
  std::uint64_t seen = 0;  ///< sequence number of the last value read
  Instant stamp = 0;       ///< when the value read was written (start of the writing job)
  /// The value itself, held still, in an exchange in which the reader has a slot of its own.
  const void* data = nullptr;
  static constexpr std::uint64_t kNone = ~0ULL;  ///< no word was read yet
  std::uint64_t word = kNone;  ///< of that exchange; the same: `data` is still its newest value
};

}  // namespace mauve
