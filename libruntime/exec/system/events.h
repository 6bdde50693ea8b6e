// SPDX-License-Identifier: LGPL-3.0-or-later
/// The events of the tasks as text, for the log.
#pragma once

#include <cstddef>
#include <functional>
#include <string_view>

#include "exec/system/system.h"
#include "rt/ring/event_ring.h"

#include <mauve/host/report.h>

namespace mauve::exec {

/// Its thread has ended: the next drain_events() reports the events that are left in its ring.
void keep_last_events(System& system, Deployed& deployed);

[[nodiscard]] std::string_view name_of(rt::EventKind kind);

std::size_t drain_events(System& system, const std::function<void(const RuntimeEvent&)>& visit);

}  // namespace mauve::exec
