// SPDX-License-Identifier: LGPL-3.0-or-later
/// User code that did not return in time: the answer to its user, and the refusals that follow.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "commands/command.h"

namespace mauve::daemon {

/// [control] The answer of a command whose work did not return. `hook`: the function that it was
/// in; empty: not known, `at` stands for it. `now`: the state of the system after it.
[[nodiscard]] Error thread_abandoned(const Running& running, const std::string& hook,
                                     const std::string& at,
                                     const std::string& now = "nothing changed");

/// [control] The abandoned thread may still be in elements of these components, so later changes of
/// them are refused. `all`: of each of them; else only of those that are not configured.
void note_abandoned_in(Running& running, const std::vector<std::string>& components,
                       const std::string& hook, bool all);
/// [control] A change that only stops is never refused: it runs no code of the components.
[[nodiscard]] Status check_abandoned_in(const Running& running, const Change& change);

/// [any] Refused when too many threads are abandoned already, in all or by changes of this user,
/// who may not use up the number of others. No user: only in all.
[[nodiscard]] Status may_prepare(const std::vector<AbandonedThread>& left,
                                 std::optional<uid_t> user);

/// [control] The same for a change that is known; one that only stops is never refused.
[[nodiscard]] Status may_prepare_change(const Running& running, const Change& change,
                                        std::optional<uid_t> user);

/// "first, the hook second.core on_configure"
[[nodiscard]] std::string listed(const std::vector<std::string>& components,
                                 const std::vector<AbandonedThread>& hooks);

/// [control] For `status`.
[[nodiscard]] Json abandoned_threads(const Running& running);

}  // namespace mauve::daemon
