// SPDX-License-Identifier: LGPL-3.0-or-later
/// Bringing memory near before it is needed.
#pragma once

#include <cstddef>

namespace mauve::rt {

inline constexpr std::size_t kCacheLine = 64;

/// Requests the cache lines of an object, ready to be written, and does not wait. Others may write
/// it meanwhile. [rt]
inline void prefetch([[maybe_unused]] const void* object, [[maybe_unused]] std::size_t size) {
#if defined(__x86_64__)
  if (size == 0) return;
  const auto* bytes = static_cast<const volatile std::byte*>(object);
  // The builtin would request a shared line unless the compiler knows the CPU.
  for (std::size_t i = 0; i < size; i += kCacheLine) {
    asm volatile("prefetchw %0" : : "m"(bytes[i]));
  }
  asm volatile("prefetchw %0" : : "m"(bytes[size - 1]));  // objects are not aligned to lines
#endif
}

/// Requests the cache lines of an object, ready to be written, and reads each of them. When
/// touch_swap_code() returns, they are in the cache of this CPU. [rt]
inline void touch(const void* object, std::size_t size) {
  if (size == 0) return;
  prefetch(object, size);
  const auto* bytes = static_cast<const volatile std::byte*>(object);
  for (std::size_t i = 0; i < size; i += kCacheLine) static_cast<void>(bytes[i]);
  static_cast<void>(bytes[size - 1]);
}

/// Functions marked so lie together. After some milliseconds without a swap each line of their code
/// would come from memory, for 100 ns; fetched together beforehand, it comes in the time of a few.
#define MAUVE_RUNS_AT_A_SWAP [[gnu::section("mauve_swap_code")]]

/// Returns when that code is in the cache, and so are the lines that were touched before. [rt]
void touch_swap_code();
/// The bytes of that code, at most a page, on arm64 two: each needs one translation. [any]
[[nodiscard]] std::size_t swap_code_size();

}  // namespace mauve::rt
