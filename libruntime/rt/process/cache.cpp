// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/process/cache.h"

// The linker knows where the section begins and ends.
extern "C" {
[[gnu::visibility("hidden")]] extern const std::byte __start_mauve_swap_code[];
[[gnu::visibility("hidden")]] extern const std::byte __stop_mauve_swap_code[];
}

namespace mauve::rt {

/// The first function of the section, at the beginning of a page. All of the code is on this page
/// and, on arm64, the next one, so the CPU has translated its addresses when the swap begins.
[[gnu::aligned(4096)]] MAUVE_RUNS_AT_A_SWAP void touch_swap_code() {
  constexpr std::ptrdiff_t kLine = 64;
  const std::byte* const end = __stop_mauve_swap_code;
  for (const std::byte* at = __start_mauve_swap_code; at < end; at += kLine) {
    __builtin_prefetch(at);
  }
  for (const std::byte* at = __start_mauve_swap_code; at < end; at += kLine) {
    static_cast<void>(*static_cast<const volatile std::byte*>(at));
  }
#if defined(__x86_64__)
  asm volatile("lfence" : : : "memory");
#elif defined(__aarch64__)
  asm volatile("dsb ishld" : : : "memory");
#endif
}

std::size_t swap_code_size() {
  return static_cast<std::size_t>(__stop_mauve_swap_code - __start_mauve_swap_code);
}

}  // namespace mauve::rt
