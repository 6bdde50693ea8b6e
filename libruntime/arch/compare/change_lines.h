// SPDX-License-Identifier: LGPL-3.0-or-later
/// The lines of a prepared change: all differences between before and after. The same lines come
/// out whichever command or rule asked for the change.
#pragma once

#include <functional>
#include <vector>

#include "arch/compare/diff.h"
#include "mauve/host/prepared_change.h"

namespace mauve {
class ComponentBase;
}  // namespace mauve

namespace mauve::arch {

/// Does this component run now?
using Runs = std::function<bool(const ComponentBase&)>;

/// Compares the elements in force with those that the change brings, in the words of compare(). The
/// lines name values of properties, cores, state machines, connections, task attributes, elements
/// that join and leave, starts and stops. Empty: the change makes the same elements anew. Call it
/// between prepare and commit. [control]
[[nodiscard]] std::vector<Line> lines_of(const PreparedChange::Content& change, const Runs& runs);

/// Does the line show another value of a property, also of a property of a fallback core?
[[nodiscard]] bool changes_a_property(const Line& line);
/// Does the line concern more than values and whether a component runs: cores, connections,
/// elements, task attributes, plugins, rules?
[[nodiscard]] bool changes_the_topology(const Line& line);

}  // namespace mauve::arch
