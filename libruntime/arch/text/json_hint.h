// SPDX-License-Identifier: LGPL-3.0-or-later
/// Hints at common mistakes in JSON text, found by the message of the parser and the characters at
/// the place that it names.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace mauve::arch {

/// One hint, or nothing. `message` is the parser's, `last` the place of the last character that it
/// read. [any]
[[nodiscard]] std::string json_hint(std::string_view message, std::string_view text,
                                    std::size_t last);

}  // namespace mauve::arch
