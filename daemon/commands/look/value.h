// SPDX-License-Identifier: LGPL-3.0-or-later
/// The value behind an address, as JSON. [control]
#pragma once

#include "arch/parse/quantity.h"
#include "commands/model.h"

namespace mauve::daemon {

/// {"address","value","status"}; of a service "t_ns" and "age_ns" where there is a value, of a port
/// also "service" and "max_age". Never takes an item away from a queue.
[[nodiscard]] Result<Json> sample(const Running& running, const std::string& address,
                                  const Target& target);

/// The value that a condition compares; null when there is none now. The function runs no code of a
/// resource, so it refuses a value that is not stored.
[[nodiscard]] Result<Value> read(const Running& running, const arch::Quantity& quantity,
                                 Duration max_age = Duration{0});

/// As sample(), of anything that has a value: also a statistic (control.missed, control.core), a
/// status, an age, a field.
[[nodiscard]] Result<Json> sample_at(const Running& running, const std::string& address);

/// The service whose values an address shows: itself, or the service that a port is connected to;
/// else null.
[[nodiscard]] ServiceBase* service_of(const Target& target);

/// How old the values of a connection may be, as text; null for no limit.
[[nodiscard]] Json max_age_of(const Binding* binding);

}  // namespace mauve::daemon
