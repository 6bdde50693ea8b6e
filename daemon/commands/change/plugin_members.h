// SPDX-License-Identifier: LGPL-3.0-or-later
/// The components and resources that run code of one plugin, as the members of a change.
#pragma once

#include <string>

#include "commands/command.h"
#include "mauve/host/change.h"

namespace mauve::daemon {

/// [control] A change of all elements that run code of the plugin. The types in force stand for
/// those to come.
[[nodiscard]] Change members_of(const Running& running, const std::string& plugin,
                                StatePolicy state);

/// [factory] Puts the types of a new build of the plugin in place of those in force, also for the
/// fallback cores. Refused when the build lacks one of them.
Status take_new_types(const plugin::LoadedPlugin& offered, Change& change);

}  // namespace mauve::daemon
