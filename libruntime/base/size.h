// SPDX-License-Identifier: LGPL-3.0-or-later
/// Sizes in bytes as people write them: always with a unit.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "mauve/result.h"

namespace mauve {

/// Reads "65536B", "64KiB", "1MiB", "1GiB"; whole numbers only. `at` of the error is empty. [any]
[[nodiscard]] Result<std::uint64_t> parse_size(std::string_view text);

/// The same value in the largest unit that is exact. [any]
[[nodiscard]] std::string format_size(std::uint64_t bytes);

}  // namespace mauve
