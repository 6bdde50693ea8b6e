// SPDX-License-Identifier: LGPL-3.0-or-later
/// The one place where it is decided whether anything may be changed now.
#pragma once

#include <string_view>

#include "commands/command.h"

namespace mauve::daemon {

/// What somebody, or a rule, is about to do.
enum class Kind : std::uint8_t {
  harmless,  ///< touches nothing that runs: the lock itself, what is logged, what is counted
  stop,      ///< stop components: for safety, always allowed
  ending,    ///< confirm or undo the change on probation, which began before the lock
  property,  ///< change values of properties
  other,     ///< everything else: cores, connections, starts, plugins
};

/// "none", "params", "all".
[[nodiscard]] std::string_view to_string(Lock lock);

/// What a mutation is about to do; a swap that also sets properties counts as one of these.
[[nodiscard]] Kind kind_of(const Call& call);

/// [control] Refused with `conflict` while the lock forbids it. Ask before preparing a change, and
/// again before it is committed.
[[nodiscard]] Status may_change(const Running& running, Kind kind);

}  // namespace mauve::daemon
