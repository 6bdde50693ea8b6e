// SPDX-License-Identifier: LGPL-3.0-or-later
/// The log of the guardian: one line on standard error for each thing that happens.
#pragma once

namespace mauve::guardian {

/// "mauve-guardian: TEXT", as printf(3) writes it, without control characters, cut at 500. Takes no
/// memory. A line for which there is no room now is lost, so that the guardian waits for no reader.
[[gnu::format(printf, 1, 2)]] void say(const char* format, ...);

}  // namespace mauve::guardian
