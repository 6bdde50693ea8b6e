// SPDX-License-Identifier: LGPL-3.0-or-later
/// Functions of libmauve that stand before those of the C library: how they refuse a job or hook,
/// and how they reach the function that they replace. Sanitizers have functions of their own.
#pragma once

#include <atomic>

#include <dlfcn.h>

#include "rt/thread/run_guarded.h"

#define MAUVE_WIDE "which changes the whole process: "
#define MAUVE_OF_MAUVED "which changes a thread of mauved: "
#define MAUVE_AS_URGENT "whose program would be as urgent as the job: "

namespace mauve::rt {

/// A function of the C library. No guard and no heap: the first call may come from anywhere, also
/// from an allocation or before the constructors of libmauve. [any]
template <typename Function>
struct Original {
  const char* name;
  std::atomic<Function*> found{nullptr};

  Function* find() {
    Function* function = found.load(std::memory_order_relaxed);
    if (function == nullptr) {
      function = reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
      found.store(function, std::memory_order_relaxed);
    }
    return function;
  }
};

/// Ends the job or hook that the calling thread runs; other code goes on.
inline void refuse_in_body(const char* call, const char* because) {
  end_body({.call = call, .because = because});
}

}  // namespace mauve::rt
