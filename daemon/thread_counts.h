// SPDX-License-Identifier: LGPL-3.0-or-later
/// What the kernel counts of the threads of this process. Reading it costs the threads nothing.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace mauve::daemon {

/// Since the thread began.
struct ThreadCounts {
  std::uint64_t minor_faults = 0;  ///< pages that were touched for the first time
  std::uint64_t major_faults = 0;  ///< pages that were read from a disk
  std::uint64_t waits = 0;        ///< times it gave the processor away: for a release, or in a call
  std::uint64_t preemptions = 0;  ///< times the processor was taken from it
};

/// Of `stat` and `status` of a thread in /proc, as proc(5) has them; none: one is not readable.
[[nodiscard]] std::optional<ThreadCounts> read_counts(std::string_view stat,
                                                      std::string_view status);

/// Of all threads, by the name that the kernel knows (15 characters); names that several threads
/// have are left out. [any but rt]
[[nodiscard]] std::map<std::string, ThreadCounts> thread_counts();

/// Those of the thread of this component; null: none.
[[nodiscard]] const ThreadCounts* find_counts(const std::map<std::string, ThreadCounts>& all,
                                              const std::string& component);

}  // namespace mauve::daemon
