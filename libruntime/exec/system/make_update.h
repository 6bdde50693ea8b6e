// SPDX-License-Identifier: LGPL-3.0-or-later
/// The coordinator works out an update beforehand, so that the task takes it with a few pointer
/// stores.
#pragma once

#include <memory>

#include "exec/system/prepared.h"
#include "exec/update/task_update.h"

#include <mauve/time.h>

namespace mauve {
class ComponentBase;
struct Bundle;
}  // namespace mauve

namespace mauve::exec {

/// The bound of the jobs of this bundle: a job that runs longer never returns.
[[nodiscard]] Duration bound_of(const Bundle& bundle);

/// The first update of the task of a component that joins or is deployed.
[[nodiscard]] std::unique_ptr<TaskUpdate> first_bundle(const ComponentBase& component, Mode mode);

/// The update of the task of this member.
[[nodiscard]] std::unique_ptr<TaskUpdate> make_update(const PreparedMember& member);
/// The state to which a rollback leads this member.
[[nodiscard]] Origin origin_of(const PreparedMember& member, bool was_running);
/// The update that rolls the task of this member back to `origin`.
[[nodiscard]] std::unique_ptr<TaskUpdate> make_rollback(const PreparedMember& member,
                                                        const Origin& origin);

}  // namespace mauve::exec
