// SPDX-License-Identifier: LGPL-3.0-or-later
/// Quarantine: a new core that failed and was rolled back is not put in force again until somebody
/// releases it, or its plugin is another build. Nobody else of that change is kept out; nor is
/// anybody when a change is undone, or not confirmed. The state directory keeps the list.
#pragma once

#include "commands/command.h"

namespace mauve::daemon {

/// Takes up the list of the run before. Before the first client.
void restore_quarantine(Running& running);

/// [control] The build of the plugin that a core is of; empty: of none that is loaded.
[[nodiscard]] std::string build_of(const Running& running, const std::string& core);

/// [control] False: it is there already.
bool quarantine(Running& running, const std::string& core, const std::string& reason);

/// [control] Refuses a core of this build while it is in quarantine.
[[nodiscard]] Status check_quarantine(const Running& running, const std::string& component,
                                      const std::string& core, const std::string& build_id);

/// [control] Refuses a change that would put a core in force that is in quarantine.
[[nodiscard]] Status check_quarantine(const Running& running, const Change& change);

/// [control] For `status`: rules and transactions that fail while a core is in quarantine, a row
/// each
/// `{"user","core","reason"}`. `user` is "rule in_the_building", or "transaction slow_down" where a
/// component may request it. A fallback core takes over also from quarantine.
[[nodiscard]] Json lost_to_quarantine(const Running& running);

}  // namespace mauve::daemon
