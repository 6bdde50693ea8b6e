// SPDX-License-Identifier: LGPL-3.0-or-later
/// A change in place: park the component, exchange the cores on [factory], let the component go on.
#pragma once

#include <functional>
#include <memory>

#include "commands/change/change.h"

namespace mauve::daemon {

/// [factory] Makes the elements of the change and configures none of them.
using PrepareInPlace = std::function<Result<PreparedChange>(Change&)>;

/// [control] As apply(), for a change in place. It is refused unless it makes the core of exactly
/// one component anew.
void apply_in_place(Running& running, const CallPtr& call, Ticket ticket, Change change,
                    std::shared_ptr<ChangeHooks> hooks, PrepareInPlace prepare = nullptr);

/// [control] In place if the call asks for that (`in_place`), else beside what runs.
void apply_as_asked(Running& running, const CallPtr& call, Ticket ticket, Change change,
                    std::shared_ptr<ChangeHooks> hooks = nullptr);

}  // namespace mauve::daemon
