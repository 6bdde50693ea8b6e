// SPDX-License-Identifier: LGPL-3.0-or-later
/// The components and resources that run code of one plugin, as the members of a change.
#pragma once

#include <string>

#include "arch/compare/change_lines.h"
#include "commands/command.h"
#include "mauve/host/change.h"

namespace mauve::daemon {

/// [control] A change with one edit for each component and resource that runs code of the plugin.
/// The edits hold the types in force; take_new_types() replaces them with those of a new build.
[[nodiscard]] Change members_of(const Running& running, const std::string& plugin,
                                StatePolicy state);

/// [factory] Replaces the types of the edits, and those of fallback cores, with the types of a new
/// build of the plugin. An error names a type that the build lacks.
Status take_new_types(const plugin::LoadedPlugin& offered, Change& change);

/// [control] The difference between the build of a plugin that has its names and this new one.
[[nodiscard]] arch::Line line_of_build(const Running& running, const plugin::LoadedPlugin& offered);

}  // namespace mauve::daemon
