// SPDX-License-Identifier: LGPL-3.0-or-later
/// The one place where it is decided whether anything may be changed now.
#pragma once

#include <string_view>
#include <vector>

#include "arch/compare/change_lines.h"

#include "commands/command.h"
#include "rules/supervision.h"

namespace mauve::daemon {

/// The kind of a request of a client or a rule, as far as the request itself tells.
enum class Kind : std::uint8_t {
  harmless,  ///< touches nothing that runs: the lock itself, what is logged, what is counted
  stop,      ///< stop components: for safety, always allowed
  ending,    ///< confirm or undo the change on probation, which began before the lock
  other,     ///< everything else: properties, cores, connections, starts, plugins
};

/// "none", "params", "topology", "all".
[[nodiscard]] std::string_view to_string(Lock lock);

[[nodiscard]] Kind kind_of(const Call& call);

/// [control] Refused with `conflict` while everything is locked. Ask before preparing a change, and
/// again before it is committed.
[[nodiscard]] Status may_change(const Running& running, Kind kind);

/// [control] Refused with `conflict` while a lock holds something that the change makes different,
/// whatever asked for it. Ask when the change is prepared, before it is committed.
[[nodiscard]] Status may_change(const Running& running, const std::vector<arch::Line>& lines);

/// Why the lock keeps a rule with these steps from firing; empty: it does not.
[[nodiscard]] std::string_view held_by(Lock lock, const rules::Steps& steps);

}  // namespace mauve::daemon
