// SPDX-License-Identifier: LGPL-3.0-or-later
/// Bringing memory near before it is needed.
#pragma once

#include <cstddef>

namespace mauve::rt {

/// Returns when the cache lines of an object are in the cache of this CPU, ready to be written.
/// [rt]
inline void touch(const void* object, std::size_t size) {
  if (size == 0) return;
  constexpr std::size_t kLine = 64;
  const auto* bytes = static_cast<const volatile std::byte*>(object);
#if defined(__x86_64__)
  // The builtin would ask for a shared line unless the compiler is told of the CPU.
  for (std::size_t i = 0; i < size; i += kLine) asm volatile("prefetchw %0" : : "m"(bytes[i]));
  asm volatile("prefetchw %0" : : "m"(bytes[size - 1]));
#endif
  for (std::size_t i = 0; i < size; i += kLine) static_cast<void>(bytes[i]);
  static_cast<void>(bytes[size - 1]);  // objects are not aligned to lines
}

/// Functions marked so lie together. After some milliseconds without a swap each line of their code
/// would come from memory, for 100 ns; fetched together beforehand, it comes in the time of a few.
#define MAUVE_RUNS_AT_A_SWAP [[gnu::section("mauve_swap_code")]]

/// Returns when that code is near, and what was touched before. [rt]
void touch_swap_code();

}  // namespace mauve::rt
