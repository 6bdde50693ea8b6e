// SPDX-License-Identifier: LGPL-3.0-or-later
/// Quarantine: a new core that failed and was rolled back is not put in force again, unless a
/// reaction needs it. A reaction is a rule, a transaction, or a fallback core. It leaves quarantine
/// when a user releases it, when its plugin is another build, or when a reaction names it. The
/// other cores of that change do not enter quarantine. An undone change, and one that was not
/// confirmed, bring no core into quarantine. A component that runs the core already goes on with
/// it. The state directory keeps the list.
#pragma once

#include <functional>
#include <set>
#include <string>

#include "commands/command.h"

namespace mauve::daemon {

/// Takes up the list of the run before. Before the first client.
void restore_quarantine(Running& running);

/// [control] The build of the plugin that a core is of; empty: of none that is loaded.
[[nodiscard]] std::string build_of(const Running& running, const std::string& core);
[[nodiscard]] std::string build_of(const plugin::Catalog& catalog, const std::string& core);

/// [control] The first reaction that brings this core: "rule in_the_building", "transaction
/// slow_down" or "the fallback core of control". Empty: none does.
[[nodiscard]] std::string reaction_with(const Running& running, const std::string& core);

/// [control] Unless a reaction needs the core. The log says what happened.
void quarantine(Running& running, const std::string& core, const std::string& reason);

/// The build of the plugin that a core of this name is of.
using BuildOf = std::function<std::string(const std::string& core)>;

/// [control] Takes the cores out that a reaction needs since the last look.
void spare_reactions(Running& running);

/// [control] Refuses a change that would put a core in force, or let a fallback core stand by, that
/// is in quarantine. `build`: where the change brings builds that are not loaded yet; null: those
/// that are loaded.
[[nodiscard]] Status check_quarantine(const Running& running, const Change& change,
                                      const BuildOf& build = {});

/// [control] Whether the loaded build of this core is.
[[nodiscard]] bool is_in_quarantine(const Running& running, const std::string& core);

/// [control] The next step for a component that does not run. A start is none for one whose core is
/// in quarantine: it would fail again, and a fresh core of this build is refused.
[[nodiscard]] std::string step_to_run(const Running& running, const ComponentStatus& component);

/// The cores of `quarantine.list` whose build is the one that is loaded.
[[nodiscard]] std::set<std::string, std::less<>> cores_in(const Json& list,
                                                          const plugin::Catalog& catalog);

}  // namespace mauve::daemon
