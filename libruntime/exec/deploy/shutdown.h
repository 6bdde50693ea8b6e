// SPDX-License-Identifier: LGPL-3.0-or-later
/// Orderly end in bounded time.
#pragma once

#include <string>
#include <vector>

#include <mauve/time.h>

namespace mauve::exec {

class System;

/// shutdown(): see Deployer.
std::vector<std::string> bring_down(System& system, Duration bound,
                                    Duration ordinary = Duration{0});

/// How long a stop waits for one component, so that the whole stop takes little longer than
/// `bound`.
[[nodiscard]] Duration patience_within(Duration bound);

}  // namespace mauve::exec
