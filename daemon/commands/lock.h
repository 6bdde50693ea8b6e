// SPDX-License-Identifier: LGPL-3.0-or-later
/// Locks and roles judge the differences that a change makes, whichever method or rule asks for it.
/// docs/maintaining/changes.md lists the other reasons to refuse a change.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "arch/compare/change_lines.h"

#include "commands/command.h"
#include "rules/supervision.h"

namespace mauve::daemon {

/// The kind of a request of a client or a rule, as far as the request itself shows.
enum class Kind : std::uint8_t {
  harmless,  ///< touches nothing that runs: sets the lock itself, levels of the log, counters
  stop,      ///< stop components: for safety, always allowed
  ending,    ///< a probation ends: to confirm changes nothing that runs, and undo() judges its own
             ///< lines
  steps,     ///< steps, which may be stops only: the change that they make is judged
  other,     ///< everything else, also a method that the table does not classify
};

/// "none", "params", "topology", "all".
[[nodiscard]] std::string_view to_string(Lock lock);

[[nodiscard]] Kind kind_of(const Call& call);

/// [control] Refused with `conflict` while everything is locked, but for stops, a confirmation, and
/// steps, whose change is judged. Ask before preparing a change, and again before it is committed.
[[nodiscard]] Status check_lock_of_all(const Running& running, Kind kind);

/// The change stops components, and makes nothing else different. Neither a lock nor a quarantine
/// nor an abandoned thread refuses such a change.
[[nodiscard]] bool only_stops(const Change& change);

/// [control] The change starts and stops components, and makes nothing else different. It brings
/// nothing that a probation could prove, and a rollback from a start would only stop the component
/// again. That holds for a start with a fresh core of the same type too.
[[nodiscard]] bool only_starts_and_stops(const Running& running, const Change& change);

/// [control] Refused with `conflict` while everything is locked, unless the change only_stops().
/// Ask before preparing it, and again before it is committed.
[[nodiscard]] Status check_lock_of_all(const Running& running, const Change& change);

/// [control] Refused with `conflict` while a lock holds something that the change makes different,
/// and with `not_permitted` when one of the differences needs a higher role than the caller has.
/// Every way to change something asks this when its change is prepared, before it is committed.
[[nodiscard]] Status may_change(const Running& running, const Call& call,
                                const std::vector<arch::Line>& lines);

/// The role that may make this difference. A kind of difference that is not classified needs an
/// administrator.
[[nodiscard]] server::Role role_for(const arch::Line& line);

/// Why the lock keeps a rule with these steps from firing; empty: it does not.
[[nodiscard]] std::string_view held_by(Lock lock, const rules::Steps& steps);

/// [control] The names of the rules that the lock keeps from firing, each with held_by().
[[nodiscard]] std::map<std::string, std::string_view> held_rules(const Running& running);

}  // namespace mauve::daemon
