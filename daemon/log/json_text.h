// SPDX-License-Identifier: LGPL-3.0-or-later
/// Just enough JSON to write a log line: a quoted string.
#pragma once

#include <string>
#include <string_view>

namespace mauve::logging {

/// [any] `text` quoted for JSON. Bytes that are not UTF-8 become U+FFFD, so that a line from a
/// broken plugin can still be read by every tool.
[[nodiscard]] std::string json_string(std::string_view text);

}  // namespace mauve::logging
