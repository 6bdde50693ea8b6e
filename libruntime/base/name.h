// SPDX-License-Identifier: LGPL-3.0-or-later
/// "Did you mean ...?": the nearest of the names that exist.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace mauve {

/// The known name with the fewest single-character edits from `wanted` (a swap of two neighbours
/// counts as one), of equals the first; else a known name that `wanted` begins; else "". [any]
[[nodiscard]] std::string nearest_name(std::string_view wanted,
                                       const std::vector<std::string>& known);

/// The hint "did you mean NAME?", the name between two `quote`; "" when none is near. [any]
[[nodiscard]] std::string did_you_mean(std::string_view wanted,
                                       const std::vector<std::string>& known,
                                       std::string_view quote = "");

/// The same hint; when none is near, "there are A, B, C", with twelve names at most. [any]
[[nodiscard]] std::string known_names(std::string_view wanted,
                                      const std::vector<std::string>& known);

}  // namespace mauve
