// SPDX-License-Identifier: LGPL-3.0-or-later
/// Other programs with real-time threads: they come between the components of a mauved, and a probe
/// above all of them does not see it. Line threads, [io] or [safe] of another mauved precede no
/// component of these tests.
#pragma once

#include <sched.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <system_error>

#include "support/temp_dir.h"

namespace mauve::test {

inline constexpr int kBelowComponents = 2;

/// "bench-raw of process 4711": the first that is found beside this process and `ours`; else empty.
inline std::string foreign_realtime(pid_t ours) {
  namespace fs = std::filesystem;
  std::error_code gone;  // processes end while they are looked at
  for (const auto& process : fs::directory_iterator("/proc", gone)) {
    const int id = std::atoi(process.path().filename().c_str());
    if (id <= 0 || id == ours || id == getpid()) continue;
    if (TempDir::read(process.path() / "cmdline").empty()) continue;  // one of the kernel's
    for (const auto& thread : fs::directory_iterator(process.path() / "task", gone)) {
      const int its = std::atoi(thread.path().filename().c_str());
      const int policy = sched_getscheduler(its);
      if (policy != SCHED_FIFO && policy != SCHED_RR) continue;
      sched_param urgency{};
      if (sched_getparam(its, &urgency) == 0 && urgency.sched_priority <= kBelowComponents)
        continue;
      std::string name = TempDir::read(thread.path() / "comm");
      name.erase(name.find_last_not_of('\n') + 1);
      return name + " of process " + std::to_string(id);
    }
  }
  return {};
}

}  // namespace mauve::test
