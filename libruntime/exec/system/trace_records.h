// SPDX-License-Identifier: LGPL-3.0-or-later
/// The records of a trace, from the rings of all threads.
#pragma once

#include <cstddef>
#include <functional>

#include <mauve/trace.h>

namespace mauve::exec {

class System;
struct Deployed;

/// Collects the records of a component that leaves, before its task is freed. [control]
void keep_last_trace(System& system, Deployed& deployed);

/// Deployer::drain_trace(). [trace]
std::size_t drain_trace(System& system, const std::function<void(const TraceRecord&)>& visit);

}  // namespace mauve::exec
