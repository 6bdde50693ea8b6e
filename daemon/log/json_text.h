// SPDX-License-Identifier: LGPL-3.0-or-later
/// Texts of others in a log line: as a quoted string of JSON, or for a terminal.
#pragma once

#include <string>
#include <string_view>

namespace mauve::logging {

/// [any] `text` quoted for JSON. Bytes that are not UTF-8 become U+FFFD, so that a line from a
/// broken plugin can still be read by every tool.
[[nodiscard]] std::string json_string(std::string_view text);

/// [any] `text` as one line without effect on a terminal. Control characters, and those that turn
/// the direction of writing, are written as escapes ("\\n", "\\u001b"). Bytes that are not UTF-8
/// become U+FFFD.
[[nodiscard]] std::string printable(std::string_view text);

}  // namespace mauve::logging
