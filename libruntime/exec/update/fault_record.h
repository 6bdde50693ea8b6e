// SPDX-License-Identifier: LGPL-3.0-or-later
/// FaultRecord: a failure as the task that fails records it, all at the same instant. Rollbacks and
/// standby cores carry a copy of their own, so that a later failure of the same component does not
/// mix with it.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include <mauve/time.h>

namespace mauve::exec {

/// Why a core failed.
enum class Cause : std::uint8_t { threw, implausible, over_budget, overruns, crashed, hung, asked };

/// "threw", "wrote an implausible value", ...
[[nodiscard]] std::string_view to_string(Cause cause);
/// "threw", "implausible", ...
[[nodiscard]] std::string_view word_of(Cause cause);

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
  std::array<char, 128> text{};
  std::array<char, 64> core{};
  std::array<char, 64> state{};
  const void* inside = nullptr;  ///< lock of the resource that failed it; null: it failed itself
};

}  // namespace mauve::exec
