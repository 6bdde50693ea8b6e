// SPDX-License-Identifier: LGPL-3.0-or-later
/// Sizes of campaigns, which the environment may set.
#pragma once

#include <cstdint>
#include <cstdlib>

namespace mauve::test {

/// The number in this variable of the environment, else `otherwise`.
inline std::uint64_t number_in(const char* variable, std::uint64_t otherwise) {
  const char* given = std::getenv(variable);
  return given == nullptr ? otherwise : std::strtoull(given, nullptr, 10);
}

}  // namespace mauve::test
