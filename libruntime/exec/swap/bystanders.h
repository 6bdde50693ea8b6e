// SPDX-License-Identifier: LGPL-3.0-or-later
/// Components that wait at the barrier of a change.
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

/// The components that run and would wait now.
[[nodiscard]] std::vector<PreparedBarrier::Wait> waits_of(System& system,
                                                          const PreparedChange::Content& content);

}  // namespace mauve::exec
