// SPDX-License-Identifier: LGPL-3.0-or-later
/// A swap in place: park the component, exchange the cores on [factory], let the component go on.
#pragma once

#include <memory>

#include "commands/change/change.h"

namespace mauve::daemon {

/// [control] As apply(), for a swap in place.
void apply_in_place(Running& running, const CallPtr& call, Ticket ticket, Edit edit,
                    std::shared_ptr<ChangeHooks> hooks);

}  // namespace mauve::daemon
