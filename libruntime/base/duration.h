// SPDX-License-Identifier: LGPL-3.0-or-later
/// Durations as people write them: always with a unit, always exact.
#pragma once

#include <chrono>
#include <string>
#include <string_view>

#include "mauve/result.h"

namespace mauve {

/// Reads "10ms", "250us", "1.5ms", "100ns", "1s", "2min", "1h". [any] Refused, with a hint: a
/// number without a unit, a sign, a value that is no whole number of nanoseconds. Refused too: a
/// value beyond 64 bits of nanoseconds (292 years). `at` of the error is empty.
[[nodiscard]] Result<std::chrono::nanoseconds> parse_duration(std::string_view text);

/// The shortest text that parse_duration() reads back as the same value: "1.5ms", "250us", "0s".
/// A negative value is written with a leading '-' (it is for people, and is not read back). [any]
[[nodiscard]] std::string format_duration(std::chrono::nanoseconds value);

}  // namespace mauve
