// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/process/memory.h"

#include <atomic>
#include <cerrno>
#include <cstring>
#include <string>

#include <malloc.h>
#include <sys/mman.h>
#include <sys/resource.h>

namespace mauve::rt {

namespace {

std::atomic<bool> locked{false};

/// Whether the limit does not hold for this process: only CAP_IPC_LOCK locks a page when it is 0.
/// The flag in /proc would not do, as the capability of a user namespace counts for nothing here.
bool may_exceed(const rlimit& limit) {
  const rlimit none{0, limit.rlim_max};
  const char page = 0;
  if (setrlimit(RLIMIT_MEMLOCK, &none) != 0) return false;
  const bool permitted = mlock(&page, sizeof page) == 0;
  if (permitted) munlock(&page, sizeof page);
  setrlimit(RLIMIT_MEMLOCK, &limit);
  return permitted;
}

}  // namespace

Status lock_memory() {
  // A finite limit would make a later pthread_create or malloc fail in the middle of the night.
  rlimit limit{};
  getrlimit(RLIMIT_MEMLOCK, &limit);
  mallopt(M_TRIM_THRESHOLD, -1);
  mallopt(M_MMAP_MAX, 0);
  // A thread that allocates for the first time gets an arena; locked, its spare room is real.
  mallopt(M_TOP_PAD, 16 * 1024);
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return ok();  // the shadow memory of a sanitizer cannot be locked
#endif
  const bool limited = limit.rlim_cur != RLIM_INFINITY && !may_exceed(limit);
  if (!limited && mlockall(MCL_CURRENT | MCL_FUTURE) == 0) {
    locked.store(true);
    return ok();
  }
  const std::string reason = limited ? "the limit is finite" : std::strerror(errno);
  munlockall();
  return refuse(
      {Errc::not_permitted, "memory_not_locked"}, "realtime",
      "memory cannot be locked: " + reason + " (RLIMIT_MEMLOCK is " +
          (limit.rlim_cur == RLIM_INFINITY ? std::string("unlimited")
                                           : std::to_string(limit.rlim_cur / 1024) + " KiB") +
          ")",
      "grant CAP_IPC_LOCK, or a limit: `USER - memlock unlimited` in "
      "/etc/security/limits.conf, LimitMEMLOCK=infinity in a unit");
}

bool memory_is_locked() { return locked.load(); }

}  // namespace mauve::rt
