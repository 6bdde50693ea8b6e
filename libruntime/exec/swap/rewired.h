// SPDX-License-Identifier: LGPL-3.0-or-later
/// The architecture as a change, or its rollback, would leave it.
#pragma once

#include <set>

#include "exec/system/prepared.h"
#include "model/component/wiring.h"

namespace mauve::exec {

/// The connections with the change in force. [control], or [factory] with the model locked
[[nodiscard]] Wiring rewired(const Architecture& architecture,
                             const PreparedChange::Content& change);

/// Would an output have two writers with `change` in force, when `before` is rolled back? [control]
[[nodiscard]] bool clash(const Architecture& architecture, const PreparedChange::Content& change,
                         const PreparedChange::Content& before);

/// Refuses a change that would leave an unsound architecture. In a sound one names are unique, no
/// element is connected to one that is not there, no resource reaches itself, and no output has two
/// writers. The preparation checks it; the commit checks it again when the architecture changed
/// meanwhile, for example by a rollback. [control], or [factory] with the model locked
Status check_fit(const Architecture& architecture, const PreparedChange::Content& change);

/// The resources that the change touches, and those that write on into them. [control], or
/// [factory] with the model locked
[[nodiscard]] std::set<const ResourceBase*> resources_touched(
    const Architecture& architecture, const PreparedChange::Content& change);

}  // namespace mauve::exec
