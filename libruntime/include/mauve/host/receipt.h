// SPDX-License-Identifier: LGPL-3.0-or-later
/// Receipt: the answer to a change.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <mauve/time.h>

namespace mauve {

/// The cost of a change for one component.
struct MemberReceipt {
  std::string name;          ///< of the component or resource
  Duration pause{0};         ///< measured on its thread: its next job begins at most so much later
  std::uint64_t missed = 0;  ///< releases lost while the change was made, for any cause
  std::size_t bytes = 0;     ///< size of the state handed over
  /// The types of the states that were dropped, "a and b", and the size of their objects.
  std::string dropped = {};
  std::size_t dropped_bytes = 0;  ///< of those objects
  /// The types of a state that was converted: "count/1 -> count/2".
  std::string converted = {};
  /// Its core was replaced by one that is mauve::Stateless, and nothing was dropped.
  bool begins_anew = false;
};

/// The state in which a change leaves the system. A rollback is a later change of its own.
enum class ChangeState : std::uint8_t {
  unchanged,  ///< as before
  applied,    ///< the change is in force
};
/// "unchanged", "applied".
[[nodiscard]] std::string_view to_string(ChangeState state);

/// Answer to every change.
struct Receipt {
  std::uint64_t generation = 0;                ///< that it made; in force if it made none
  ChangeState state = ChangeState::unchanged;  ///< of the system
  Duration commit{0};                          ///< logical instant of the change, since T0
  unsigned attempts = 0;                       ///< tries until the coordinator met its instant
  std::vector<MemberReceipt> components;       ///< those that took part
  std::vector<std::string> warnings = {};  ///< proofs that are missing (Admission::warn), wiring
  /// States that are kept although their fields were not compared, cores that begin fresh because
  /// the core before declares no state, and states that a rollback cannot bring back. Also open
  /// probations: those that this change joins, and those that it ends early.
  std::vector<std::string> notes = {};
};

}  // namespace mauve
