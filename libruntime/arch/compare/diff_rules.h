// SPDX-License-Identifier: LGPL-3.0-or-later
/// Two supervisions compared.
#pragma once

#include <string>
#include <vector>

#include "arch/compare/diff.h"
#include "rules/supervision.h"

namespace mauve::arch {

/// One line for each transaction, rule and permission that differs, by name, and one when the rules
/// are the same but for their order. Nothing differs: empty. [any]
[[nodiscard]] std::vector<Line> compare(const rules::Supervision& present,
                                        const rules::Supervision& wanted);

/// The names of the wanted rules that are new, or differ, or apply a transaction that differs.
/// [any]
[[nodiscard]] std::vector<std::string> changed_rules(const rules::Supervision& present,
                                                     const rules::Supervision& wanted);

}  // namespace mauve::arch
