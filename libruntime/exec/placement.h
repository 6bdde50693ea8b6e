// SPDX-License-Identifier: LGPL-3.0-or-later
/// On which CPU a component runs whose task names none.
#pragma once

#include <set>
#include <vector>

#include "exec/system.h"

namespace mauve::exec {

/// Resources whose lock a call through these connections may take, by themselves or through their
/// own ports. Those of SharedData are held for some stores and are not among them.
[[nodiscard]] std::set<ResourceBase*> locks_of(const Bindings& bindings);

/// Errors: a CPU that is not there.
[[nodiscard]] Status check_cpus(const TaskAttributes& task, const std::string& component);
/// Pinned where the task says; else where those are with whom it shares a lock, since priority
/// inheritance holds on one CPU; else where the fewest are so far.
void place(System& system, Deployed& deployed);
/// The CPU with the fewest components; `more` are on their way.
[[nodiscard]] int least_used_cpu(const System& system, const std::vector<int>& more = {});

}  // namespace mauve::exec
