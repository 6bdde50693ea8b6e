// SPDX-License-Identifier: LGPL-3.0-or-later
/// Durations and instants: one unit, nanoseconds of the monotonic clock.
#pragma once

#include <chrono>
#include <cstdint>

namespace mauve {

/// Every duration of the API. Text form always has a unit: "10ms".
using Duration = std::chrono::nanoseconds;

/// Nanoseconds of the monotonic clock (or of a ManualClock); never wall time.
using Instant = std::int64_t;

using namespace std::chrono_literals;  // 10ms in a declaration of a state

}  // namespace mauve
