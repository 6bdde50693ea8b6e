// SPDX-License-Identifier: LGPL-3.0-or-later
/// FaultRecord: one failure, which the task writes in its reaction to it; the guard does when the
/// task has no thread left. Rollbacks and standby cores carry a copy of their own, so that a later
/// failure of the same component does not mix with it.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include <mauve/time.h>

namespace mauve::exec {

/// Why a core failed, or why its change was rolled back.
enum class Cause : std::uint8_t {
  threw,        ///< a job threw an exception
  implausible,  ///< on probation: a port refused the value that a job wrote
  over_budget,  ///< on probation: several jobs used more processor time than their budget
  overruns,     ///< too many of the last 64 jobs ended late; on probation the core is to blame
  crashed,      ///< a job received a signal such as SIGSEGV, or called abort() or exit()
  hung,         ///< a job did not return within its bound
  asked,        ///< no failure: a rollback was requested. The last cause.
};

/// The names of the causes, in their order: those of the entries in errors.def that `mauvectl
/// explain` prints. Traces have threw, crashed and hung, which FaultReaction::report() records.
inline constexpr std::array<std::string_view, 7> kCauseWords{
    "threw", "implausible", "over_budget", "overruns", "crashed", "hung", "asked"};
static_assert(kCauseWords.size() == static_cast<std::size_t>(Cause::asked) + 1);

/// As the log and `mauvectl why` print it: "threw", "wrote a value that is not plausible", ...
[[nodiscard]] std::string_view to_string(Cause cause);
/// "threw", "implausible", ...
[[nodiscard]] std::string_view word_of(Cause cause);
/// The cause that to_string() prints like this, if any.
[[nodiscard]] std::optional<Cause> cause_of(std::string_view text);

/// Copies as much as there is room for; the copy ends with zero.
template <std::size_t N>
void copy_text(std::array<char, N>& to, std::string_view from) {
  to.fill(0);
  from.copy(to.data(), N - 1);
}

/// Of fixed size, since a real-time thread writes it.
struct FaultRecord {
  Instant time = 0;
  Cause cause = Cause::asked;
  std::uint64_t job = 0;  ///< jobs of the component so far, this one included
  /// The details: text of the exception, name of the signal or the port, or measured times.
  std::array<char, 128> text{};
  std::array<char, 64> core{};
  std::array<char, 64> state{};
  /// The lock of the resource in whose service the job failed; null: the core is to blame.
  const void* failed_in_lock = nullptr;
};

}  // namespace mauve::exec
