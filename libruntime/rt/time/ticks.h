// SPDX-License-Identifier: LGPL-3.0-or-later
/// Ticks: the monotonic clock, read from the counter of the processor in half the time. A call of
/// tie_ticks() ties the counter to the clock now and then; a reader never waits for that.
#pragma once

#include <mauve/time.h>

namespace mauve::rt {

/// Nanoseconds of CLOCK_MONOTONIC. From one reading to the next it may be some 10 ns early when the
/// counter was tied anew in between. Asks the system when the counter is not tied, was not for ten
/// seconds, or is nothing to go by on this machine. [rt]
[[nodiscard]] Instant fast_now();

/// Ties the counter, if half a second passed since the last time. At first twice, 100 ms apart,
/// before it counts. [any but rt]
void tie_ticks();

/// Does fast_now() read the counter? [any]
[[nodiscard]] bool ticks_are_tied();

}  // namespace mauve::rt
