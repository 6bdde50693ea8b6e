// SPDX-License-Identifier: LGPL-3.0-or-later
/// The value behind an address, as JSON. [control]
#pragma once

#include "commands/model.h"

namespace mauve::daemon {

/// {"address","value","status"}, and "service" for a port. Never takes an item away from a queue.
[[nodiscard]] Result<Json> sample(const Running& running, const std::string& address,
                                  const Target& target);

/// The service whose values an address shows: itself, or what a port is connected to; else null.
[[nodiscard]] ServiceBase* service_of(const Target& target);

}  // namespace mauve::daemon
