// SPDX-License-Identifier: LGPL-3.0-or-later
/// Threads that jobs and hooks start: while one runs, the code that started it must stay mapped.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <pthread.h>

namespace mauve::rt {

/// Code of one shared object.
struct CodeRange {
  std::uintptr_t begin = 0;
  std::uintptr_t end = 0;

  [[nodiscard]] bool contains(std::uintptr_t address) const {
    return begin <= address && address < end;
  }
};

/// The object that `address` lies in; nothing: empty. Not on a real-time thread.
[[nodiscard]] CodeRange code_around(const void* address);

/// The names of threads that still run and that code of this range started, in a job or a hook. The
/// code started them itself, or a thread of such a kind did. libmauve sees each pthread_create()
/// and its caller; under a sanitizer it does not. Not on a real-time thread.
[[nodiscard]] std::vector<std::string> threads_started_by(const CodeRange& range);

/// Did a job or a hook start this thread, or a thread of such a kind? Also of one that has ended
/// and is not joined. Not on a real-time thread.
[[nodiscard]] bool started_in_body(pthread_t thread);

}  // namespace mauve::rt
