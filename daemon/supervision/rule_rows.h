// SPDX-License-Identifier: LGPL-3.0-or-later
/// The rows of answers about rules, from the engine that watches them. [control]
#pragma once

#include <string>

#include "protocol/message.h"
#include "rules/engine.h"

namespace mauve::daemon {

using protocol::Json;

/// "is nan", "not there".
[[nodiscard]] std::string shown(const rules::SightChange& change);

/// "rule too_hot cannot be judged and does not fire (when_unknown is hold)".
[[nodiscard]] std::string consequence(const rules::Engine& engine,
                                      const rules::SightChange& change);

/// The unknown values that rules look at, with the consequences.
[[nodiscard]] Json lost_values(const rules::Engine& engine);

/// The rules that have no effect although their condition holds.
[[nodiscard]] Json blocked_rules(const rules::Engine& engine, Instant now,
                                 const rules::ReadFresh& read);

/// One rule, by its index.
[[nodiscard]] Json rule_row(const rules::Engine& engine, std::size_t rule, Instant now, Instant t0,
                            const rules::ReadFresh& read);

}  // namespace mauve::daemon
