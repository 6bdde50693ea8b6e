// SPDX-License-Identifier: LGPL-3.0-or-later
/// Counts reads and writes of terminals, and openings of whatever, by threads that are watched.
#pragma once

#include <cstddef>

namespace tty {

/// So far, all watched threads.
std::size_t calls();
/// From now on (or no longer) those of this thread are counted.
void watch_this_thread(bool watched);

}  // namespace tty
