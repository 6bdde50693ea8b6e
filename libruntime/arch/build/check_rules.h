// SPDX-License-Identifier: LGPL-3.0-or-later
/// Checks rules, transactions and permissions of a Spec against the architecture that it builds.
#pragma once

#include "arch/parse/spec.h"
#include "model/component/wiring.h"
#include "rules/supervision.h"

namespace mauve {
class Architecture;
}  // namespace mauve
namespace mauve::plugin {
class Catalog;
}  // namespace mauve::plugin

namespace mauve::arch {

/// Refused: a comparison of a condition that can never hold. There is no such address (with the
/// nearest name), its value is of another kind, is never this word, or is not stored. [control]
[[nodiscard]] Status check_comparison(const Architecture& architecture,
                                      const rules::Comparison& comparison);

/// Every error goes to `problems`: addresses in conditions and steps (with the nearest name), kinds
/// of values, words that a value never is, cores that do not fit. So do refused values of
/// properties, and names of transactions. References to a refused element are passed over. The
/// result is whole when `problems` is empty. Runs constructors of plugins, no hooks. [control]
[[nodiscard]] rules::Supervision check_rules(const Spec& spec, const Architecture& architecture,
                                             const plugin::Catalog& catalog, Problems& problems);

/// A device that nothing makes safe (unguarded_devices()). Rules and transactions without an effect
/// while the system is as the architecture has it. They name an element or value that it lacks
/// (lost_names()), would let a second port write into an output, or would lose the state of a core.
/// Runs constructors of plugins. [control] or [factory]
[[nodiscard]] std::vector<Wiring::Note> notes_on(const rules::Supervision& supervision,
                                                 const Architecture& architecture,
                                                 const plugin::Catalog& catalog);

/// The notes on a whole file, wherever it is checked, compared or started: on its wiring
/// (Wiring::notes()), and notes_on() its rules.
[[nodiscard]] std::vector<Wiring::Note> notes_on_file(const rules::Supervision& supervision,
                                                      const Architecture& architecture,
                                                      const plugin::Catalog& catalog);

}  // namespace mauve::arch
