// SPDX-License-Identifier: LGPL-3.0-or-later
/// The components that wait at the barrier of a change, and how long.
#pragma once

#include <vector>

#include "exec/system/prepared.h"

namespace mauve {
class ComponentBase;
}  // namespace mauve

namespace mauve::exec {

class System;

/// Components that the change leaves as they are, but that reach a resource of it.
[[nodiscard]] std::vector<ComponentBase*> bystanders_of(const System& system,
                                                        const PreparedChange::Content& content);

/// The members and bystanders that run, each with the number of releases that it may lose.
[[nodiscard]] std::vector<PreparedBarrier::Wait> waits_of(System& system,
                                                          const PreparedChange::Content& content);

}  // namespace mauve::exec
