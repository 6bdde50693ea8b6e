// SPDX-License-Identifier: LGPL-3.0-or-later
/// Durations and instants: one unit, nanoseconds of the monotonic clock.
#pragma once

#include <chrono>
#include <cstdint>

#include <mauve/host/version.h>

namespace mauve {

/// Every duration of the API. Text form always has a unit: "10ms".
using Duration = std::chrono::nanoseconds;

/// Nanoseconds of the monotonic clock (or of a ManualClock); never wall time.
using Instant = std::int64_t;

/// An instant, or the time between two, in seconds.
[[nodiscard]] constexpr double to_seconds(Instant nanoseconds) {
  return static_cast<double>(nanoseconds) * 1e-9;
}
/// A duration in seconds.
[[nodiscard]] constexpr double to_seconds(Duration time) { return to_seconds(time.count()); }

}  // namespace mauve

/// For `100ms` in a declaration. The compiler looks for literals in namespaces only, never in a
/// base class; suffixes without an underscore belong to the standard, so nothing can collide.
using namespace std::chrono_literals;
