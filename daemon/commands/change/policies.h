// SPDX-License-Identifier: LGPL-3.0-or-later
/// How a request wants its change to treat state, and to take effect together. [any]
#pragma once

#include <optional>

#include "commands/command.h"

namespace mauve::daemon {

/// "drop" or nothing; anything else is refused.
[[nodiscard]] Result<StatePolicy> state_policy(const Json& params);

/// "cut", "barrier", or nothing: the change then chooses by itself. Anything else is refused.
[[nodiscard]] Result<std::optional<Sync>> sync_of(const Json& params);

}  // namespace mauve::daemon
