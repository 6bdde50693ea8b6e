// SPDX-License-Identifier: LGPL-3.0-or-later
/// Processor time: the time that a thread itself used, however often it was preempted.
#pragma once

#include <sys/resource.h>

#include <cstdint>
#include <ctime>

#include <mauve/time.h>

namespace mauve::rt {

/// Of the calling thread. A system call, about 0.4 us.
[[nodiscard]] inline Duration cpu_time() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return std::chrono::seconds(now.tv_sec) + std::chrono::nanoseconds(now.tv_nsec);
}

/// How often the calling thread gave its processor away to wait for something: it slept, or waited
/// for a lock, a device or a file. A system call, about 0.4 us.
[[nodiscard]] inline std::int64_t waits_so_far() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_nvcsw;
}

}  // namespace mauve::rt
