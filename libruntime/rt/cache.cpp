// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/cache.h"

// The linker knows where the section begins and ends.
extern "C" {
[[gnu::visibility("hidden")]] extern const std::byte __start_mauve_seldom_run[];
[[gnu::visibility("hidden")]] extern const std::byte __stop_mauve_seldom_run[];
}

namespace mauve::rt {

MAUVE_SELDOM_RUN void touch_seldom_run() {
  constexpr std::ptrdiff_t kLine = 64;
  const std::byte* const end = __stop_mauve_seldom_run;
  for (const std::byte* at = __start_mauve_seldom_run; at < end; at += kLine) {
    __builtin_prefetch(at);
  }
  for (const std::byte* at = __start_mauve_seldom_run; at < end; at += kLine) {
    static_cast<void>(*static_cast<const volatile std::byte*>(at));
  }
#if defined(__x86_64__)
  asm volatile("lfence" : : : "memory");
#endif
}

}  // namespace mauve::rt
