// SPDX-License-Identifier: LGPL-3.0-or-later
/// Transactions and rules in the form of the file.
#pragma once

#include "mauve/host/value.h"
#include "rules/supervision.h"

namespace mauve::arch {

/// `"drop_gnss": [...]` and so on.
[[nodiscard]] Value::Object describe_transactions(const rules::Supervision& supervision);
/// One object a rule; a key with its default value is left out.
[[nodiscard]] Value::Array describe_rules(const rules::Supervision& supervision);

}  // namespace mauve::arch
