// SPDX-License-Identifier: LGPL-3.0-or-later
/// The properties that an edit sets, and those that survive it. [factory]
#pragma once

#include <string_view>
#include <vector>

#include <mauve/core.h>
#include <mauve/host/change.h>

namespace mauve::exec {

/// Does the edit set a property of this element ("core", "fsm", "shell")?
[[nodiscard]] bool touches(const Edit& edit, std::string_view element);

/// A remade element starts with the values of the one it replaces.
Status copy_properties(const Configurable& from, Configurable& into);
/// Gives a core of another type its first values: see Edit::values.
Status keep_values(const Configurable& from, const Edit& edit, Configurable& into);

/// Sets the properties that the edit gives for the element called `name`.
Status set_properties(const Edit& edit, std::string_view name, Configurable& element);

/// Refuses paths that lead to none of these elements.
Status check_paths(const Edit& edit, const std::vector<std::string_view>& elements);

/// Refuses an edit that would lose the state of the core: an integrator must not vanish silently.
Status check_state_survives(const CoreBase& core, const Edit& edit);

}  // namespace mauve::exec
