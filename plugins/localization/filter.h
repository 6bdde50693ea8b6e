// SPDX-License-Identifier: LGPL-3.0-or-later
/// Filter: the extended Kalman filter with a short memory, so that late measurements count as if
/// they had come in time. Plain bytes: a change hands it over as it is.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <variant>

#include "ekf.h"

namespace localization {

/// A measurement as it is kept for a replay; a variant is plain bytes too.
using Measurement = std::variant<rover::Twist, rover::Imu, rover::Pose>;

/// Measurements of the last moments, each with the estimate after it.
struct Memory {
  static constexpr std::size_t kCapacity = 128;
  struct Entry {
    Measurement measurement;
    Estimate after;
  };

  Estimate before;                         ///< the entries
  Estimate estimate;                       ///< after them
  std::array<Entry, kCapacity> entries{};  ///< a ring, by time
  std::uint32_t first = 0;
  std::uint32_t size = 0;
  std::uint64_t late = 0;      ///< measurements that were put in between
  std::uint64_t too_late = 0;  ///< dropped: older than the window, or than the memory
  std::uint64_t refused = 0;   ///< dropped: no number, or out of all bounds, or in the future

  [[nodiscard]] Entry& at(std::size_t i) { return entries[(first + i) % kCapacity]; }
  [[nodiscard]] const Entry& at(std::size_t i) const { return entries[(first + i) % kCapacity]; }
};

/// Forgets all measurements, but not how many there were. [rt]
void start(const Estimate& estimate, Memory& memory);

/// Takes a measurement. A measurement up to `window` seconds older than the newest is put in
/// between, and the later ones are replayed. One that claims to be over `window` seconds after
/// `now` is refused. One of a minute before is of another clock and dropped. At most kCapacity
/// steps. [rt]
void add(const Parameters& parameters, const Measurement& measurement, double now, double window,
         Memory& memory);

/// The estimate of this time: the newest one carried on, or the one known then. The memory stays as
/// it is. [rt]
[[nodiscard]] Estimate predicted(const Parameters& parameters, double time, const Memory& memory);

}  // namespace localization
