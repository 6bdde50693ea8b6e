// SPDX-License-Identifier: LGPL-3.0-or-later
/// From the rings of all threads to records, and what these are about.
#pragma once

#include <cstddef>
#include <functional>

#include <mauve/trace.h>

namespace mauve::exec {

class System;
struct Deployed;

/// Deployer::drain_trace(). [trace]
std::size_t drain_trace(System& system, const std::function<void(const TraceRecord&)>& visit);
/// What a component that leaves has told is collected before its task goes. [control]
void keep_last_trace(System& system, Deployed& deployed);
/// Deployer::traced(). [control]
[[nodiscard]] TracedSystem traced(System& system);

}  // namespace mauve::exec
