// SPDX-License-Identifier: LGPL-3.0-or-later
/// The components that a start or a stop names, and its answer about those that were in the wanted
/// state already. [control]
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "commands/command.h"

namespace mauve::daemon {

/// The texts of this argument, each once, in the order in which they came.
[[nodiscard]] std::vector<std::string> names_in(const Json& params, const char* name);

/// The architecture has no component of this name, but the rollback of a change on probation brings
/// one back.
[[nodiscard]] bool is_away(const Running& running, const std::string& component);

/// Whether a request may name a component that is away.
enum class Away : std::uint8_t { refused, too };

/// Those that the request names, or all of them: refused when it does neither or both, or names one
/// that is not there. `verb`: "start".
[[nodiscard]] Result<std::vector<std::string>> components_meant(const Running& running,
                                                                const Call& call,
                                                                const std::string& verb,
                                                                Away away = Away::refused);

/// {"already": [...], "already_state": "running"}, unless there are none.
void say_already(const std::vector<std::string>& names, const char* state, Json& result);

}  // namespace mauve::daemon
