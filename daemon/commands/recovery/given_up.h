// SPDX-License-Identifier: LGPL-3.0-or-later
/// User code that did not return in time: what is told of it, and what is refused because of it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "commands/command.h"

namespace mauve::daemon {

/// [control] `hook`: what the work was in; empty: not known, `at` stands for it. `now`: how things
/// are after it.
[[nodiscard]] Error given_up(const Running& running, const std::string& hook, const std::string& at,
                             const std::string& now = "nothing changed");

/// [control] The thread that was left behind may still be in what these components run with. All:
/// no matter how they are; else only those that are not configured.
void bar(Running& running, const std::vector<std::string>& components, const std::string& hook,
         bool all);
/// [control]
[[nodiscard]] Status check_barred(const Running& running, const Change& change);

/// [any] Refused when too many threads are left behind already, in all or by changes of this user,
/// who may not use up those of others. None: only in all.
[[nodiscard]] Status may_prepare(const std::vector<LeftBehind>& left, std::optional<uid_t> user);

/// [control] For `status`.
[[nodiscard]] Json left_behind(const Running& running);

}  // namespace mauve::daemon
