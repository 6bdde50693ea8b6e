// SPDX-License-Identifier: LGPL-3.0-or-later
/// The rights of a test on this machine, asked of the kernel: mauve has the same ones.
#pragma once

#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace mauve::test {

/// True when a process may lock all of its memory, whatever its size. Only CAP_IPC_LOCK exceeds a
/// finite limit, so it is asked for under the limit 0, and in a process that ends with its locks.
[[nodiscard]] inline bool may_lock_memory() {
  const pid_t child = fork();
  if (child == 0) {
    rlimit limit{};
    getrlimit(RLIMIT_MEMLOCK, &limit);
    limit.rlim_cur = limit.rlim_cur == RLIM_INFINITY ? RLIM_INFINITY : 0;
    const bool set = setrlimit(RLIMIT_MEMLOCK, &limit) == 0;
    _exit(set && mlockall(MCL_CURRENT | MCL_FUTURE) == 0 ? 0 : 1);
  }
  int status = 1;
  return child > 0 && waitpid(child, &status, 0) == child && status == 0;
}

inline constexpr const char* kMemoryNotLocked = "SKIPPED: memory may not be locked here";

}  // namespace mauve::test
