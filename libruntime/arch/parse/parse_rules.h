// SPDX-License-Identifier: LGPL-3.0-or-later
/// "transactions", "rules", and the "may_request" of a component.
#pragma once

#include <vector>

#include "arch/parse/spec.h"
#include "arch/text/read.h"

namespace mauve::arch {

/// `"drop_gnss": [ { "disconnect": "gnss.ports.fix" } ]`
void read_transactions(const Source& source, std::vector<TransactionSpec>& into);

/// `[ { "stop": "control" } ]`: the steps of one change, outside of a file.
void read_change(const Source& source, TransactionSpec& into);

/// `{ "name": "gnss_lost", "when": "gnss.core.satellites < 4", "for": "2s", "do": "drop_gnss" }`
void read_rules(const Source& source, std::vector<RuleSpec>& into);

/// `[ "drop_gnss" ]`
void read_may_request(const Source& source, std::vector<PlacedText>& into);

}  // namespace mauve::arch
