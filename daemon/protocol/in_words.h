// SPDX-License-Identifier: LGPL-3.0-or-later
/// Values and the lines of a change as text, the same in the log, in the audit log, in the history
/// and in the client.
#pragma once

#include <cstddef>
#include <string>

#include "protocol/framing.h"

namespace mauve::protocol {

/// "0.8", "[1, 2]", "{x: 1}", "-" for null. A text stays as it is: the caller makes it harmless
/// before it goes to a terminal.
[[nodiscard]] std::string in_words(const Json& value);

/// Of {"op","kind","address","old","new"}: "~ control.core.gain: 0.6 -> 0.8",
/// "+ component watcher (safety/watcher)", "- plugin guidance".
[[nodiscard]] std::string line_in_words(const Json& line);

/// "~ a.core.x: 1 -> 2; - b.ports.in: fix.read; and 4 more". `most`: lines that are written out.
[[nodiscard]] std::string lines_in_words(const Json& lines, std::size_t most);

}  // namespace mauve::protocol
