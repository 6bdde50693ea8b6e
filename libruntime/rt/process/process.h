// SPDX-License-Identifier: LGPL-3.0-or-later
/// Processes and threads as /proc shows them. Everything reads files below a root, "/" or that of a
/// test: not on a real-time thread.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mauve::rt {

/// One thread.
struct ThreadFacts {
  int process = 0;
  int id = 0;
  std::string name;
  std::string policy;  ///< "SCHED_FIFO"
  int priority = 0;    ///< 0 of one that is not real-time
  int cpu = 0;         ///< where it ran last
  bool kernel = false;
  // Since it began:
  std::uint64_t ticks = 0;         ///< of processor time, sysconf(_SC_CLK_TCK) of them a second
  std::uint64_t minor_faults = 0;  ///< pages that were touched for the first time
  std::uint64_t major_faults = 0;  ///< pages that were read from a disk
  std::uint64_t waits = 0;         ///< times it gave the processor away, for a release or in a call
  std::uint64_t preemptions = 0;   ///< times it lost the processor to another thread

  /// Before all ordinary threads of its CPU.
  [[nodiscard]] bool urgent() const { return priority > 0 || policy == "SCHED_DEADLINE"; }
};

/// The line in /proc/PID/task/ID/stat, and the counts of `status` there; nullopt when the line
/// makes no sense.
[[nodiscard]] std::optional<ThreadFacts> thread_facts(std::string_view line,
                                                      std::string_view status = {});

/// The threads of a process, by their numbers; "self" is the caller's.
[[nodiscard]] std::vector<ThreadFacts> threads_of(const std::filesystem::path& root,
                                                  std::string_view process);

/// The facts that decide whether a process can be a real-time one.
struct ProcessFacts {
  bool root = false;                                       ///< the effective user is 0
  bool nice_capability = false;                            ///< CAP_SYS_NICE is effective
  bool lock_capability = false;                            ///< CAP_IPC_LOCK is effective
  std::uint64_t priority_limit = 0;                        ///< RLIMIT_RTPRIO
  std::optional<std::uint64_t> lock_limit = std::nullopt;  ///< RLIMIT_MEMLOCK; none: unlimited
  std::uint64_t locked_kib = 0;  ///< in memory and locked, without pages that may be locked later
  std::string cpu_group;         ///< "" where it is the root's
  std::optional<std::int64_t> group_runtime_us = std::nullopt;  ///< none: not to be read
};

/// A fact that cannot be read counts as not granted.
[[nodiscard]] ProcessFacts process_facts(const std::filesystem::path& root,
                                         std::string_view process);

/// A whole file, without the white space at its end; nothing when it cannot be read.
[[nodiscard]] std::optional<std::string> file_text(const std::filesystem::path& file);

}  // namespace mauve::rt
