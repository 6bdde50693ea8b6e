// SPDX-License-Identifier: LGPL-3.0-or-later
/// Lists of generations as people write them.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace mauve {

/// Increasing numbers: "2", "2 to 4", "34 and 36", "2 to 4, 6 and 9". Only neighbours form a range.
/// Empty for no numbers. [any but rt]
[[nodiscard]] std::string numbers_in_words(std::span<const std::uint64_t> numbers);

/// "generation 2", "generations 34 and 36". At least one number. [any but rt]
[[nodiscard]] std::string generations_in_words(std::span<const std::uint64_t> generations);

}  // namespace mauve
