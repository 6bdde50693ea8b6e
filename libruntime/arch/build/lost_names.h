// SPDX-License-Identifier: LGPL-3.0-or-later
/// Rules and transactions that name an element or a value which the system lacks now. They have no
/// effect until it is there, and cost nothing else. A core that another one replaced takes its
/// properties and observables with it, also when the rule itself asked for the replacement.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "model/component/wiring.h"
#include "rules/supervision.h"

namespace mauve {
class Architecture;
class CoreBase;
}  // namespace mauve
namespace mauve::plugin {
class Catalog;
}  // namespace mauve::plugin

namespace mauve::arch {

/// The core that a component is about to get; null: it keeps the one that it has.
using NextCore = std::function<const CoreBase*(std::string_view component)>;

/// Sentences on the rules and transactions of a running system whose names a change takes away.
/// [control]
[[nodiscard]] std::vector<Wiring::Note> names_lost_by(const rules::Supervision& supervision,
                                                      const Architecture& architecture,
                                                      const NextCore& next);

/// Sentences on all that the supervision names and the architecture does not have. Runs
/// constructors of plugins. [control] or [factory]
[[nodiscard]] std::vector<Wiring::Note> lost_names(const rules::Supervision& supervision,
                                                   const Architecture& architecture,
                                                   const plugin::Catalog& catalog);

/// The entries of "lost" in the file of this system: the names for which a start would refuse its
/// rules and transactions, each once. Runs no code of plugins. [control]
[[nodiscard]] std::vector<std::string> lost_of(const rules::Supervision& supervision,
                                               const Architecture& architecture,
                                               const plugin::Catalog& catalog);

}  // namespace mauve::arch
