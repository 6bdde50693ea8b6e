// SPDX-License-Identifier: LGPL-3.0-or-later
/// The one wait primitive: a futex with an absolute timeout on the monotonic clock. It can be
/// woken by a command, needs no lock and no descriptor.
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>

#include <mauve/time.h>

namespace mauve::rt {

inline constexpr Instant kForever = std::numeric_limits<Instant>::max();

/// Sleeps while `word` is `expected`, at most until `deadline`. May return early. [rt]
void futex_wait_until(const std::atomic<std::uint32_t>& word, std::uint32_t expected,
                      Instant deadline);

/// Adds one to the word and wakes all threads that sleep on it. [any], one system call.
void futex_bump(std::atomic<std::uint32_t>& word);

}  // namespace mauve::rt
