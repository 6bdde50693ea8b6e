// SPDX-License-Identifier: LGPL-3.0-or-later
/// The audit line of a mutation: the user, the request and its outcome. The line goes to the log as
/// an event, and is returned for the audit log of the state directory.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "commands/command.h"

namespace mauve::daemon {

/// The method of changes that mauved makes by itself: rules, requests of components, a stop after a
/// standstill.
inline constexpr std::string_view kSupervision = "supervision";

/// A call of mauved itself, with the rights of an operator, for the audit log. No client waits for
/// its answer. [any]
[[nodiscard]] CallPtr call_by_itself(const Running& running, std::string reason);
/// [any] It is such a call.
[[nodiscard]] bool by_itself(const Call& call);

/// [control] `result` as it will be answered.
[[nodiscard]] Json audit_applied(Running& running, const Call& call, const Json& result);

/// [any] The changes of a result, in the lines of `plan`: "~ a.core.x: 1 -> 2; ...".
/// Bounded; empty: nothing.
[[nodiscard]] std::string changes_of(const Json& result);

/// [any] Nothing when this user was refused too often in this second, so that it is only counted;
/// never of a refusal that changed something.
[[nodiscard]] std::optional<Json> audit_refused(Running& running, const Call& call,
                                                const Fault& fault);

/// [control] Writes down how many were only counted, in seconds that are over.
void report_counted_refusals(Running& running, std::chrono::steady_clock::time_point now);

}  // namespace mauve::daemon
