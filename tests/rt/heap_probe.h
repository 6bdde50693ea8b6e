// SPDX-License-Identifier: LGPL-3.0-or-later
/// HeapProbe: counts heap calls of this thread while it lives. Not with sanitizers, which bring
/// their own malloc.
#pragma once

#include <cstddef>

namespace heap {

/// Heap calls of watched threads so far, all threads.
std::size_t calls();
/// From now on (or no longer) calls of this thread are counted.
void watch_this_thread(bool watched);

}  // namespace heap
