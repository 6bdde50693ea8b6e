// SPDX-License-Identifier: LGPL-3.0-or-later
/// The reason why the system refuses SCHED_FIFO, and the remedy.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <mauve/result.h>

namespace mauve::rt {

/// The facts that decide about SCHED_FIFO. The kernel asks for the capability or the limit first,
/// then for run time of the control group (only where it was built with RT_GROUP_SCHED).
struct FifoFacts {
  int priority = 0;                  ///< that was asked for
  bool nice_capability = false;      ///< CAP_SYS_NICE is effective
  bool root = false;                 ///< the effective user is 0
  std::uint64_t priority_limit = 0;  ///< RLIMIT_RTPRIO
  /// cpu.rt_runtime_us; empty: not to be read
  std::optional<std::int64_t> group_runtime = std::nullopt;
};

/// The facts about the calling thread. [any], reads files: not on a real-time thread.
[[nodiscard]] FifoFacts fifo_facts(int priority);

/// The refusal that these facts explain, with its remedy.
[[nodiscard]] Error fifo_refusal(const FifoFacts& facts);

/// The path of the group that has the cpu controller (version 1), out of the text of
/// /proc/PID/cgroup. Version 2 shows no run time.
[[nodiscard]] std::optional<std::string> cpu_group(std::string_view cgroups);

}  // namespace mauve::rt
