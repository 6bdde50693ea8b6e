// SPDX-License-Identifier: LGPL-3.0-or-later
/// Changes that only stop components, and stops that overtake a change.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "commands/change/change.h"

namespace mauve::daemon {

/// [control] Whether the change starts a component for which a stop was received after this call.
/// The stop was served first, so the change is to be refused.
[[nodiscard]] bool overtaken_by_stop(const Running& running, const Call& call,
                                     const Change& change);

/// [control] Of a stop that is over. It names those that [stop] parked, which [control] met parked.
[[nodiscard]] Json answer_to_stop(const Call& call, const Receipt& receipt);

/// [control] mauved itself makes the call, which stops these components. As long as the call is
/// there, [stop] watches it as it does the stop of a user.
void watch_over_own_stop(Running& running, const CallPtr& call,
                         std::vector<std::string> components);

/// [control] A change that only_stops(), also those that stand already, is a stop: it is never
/// revoked, and one that does not end its job holds up no other. It is one of a user if the change
/// says so. `hooks` may be null.
void stop_only(Running& running, const CallPtr& call, Ticket ticket, const Change& change,
               std::shared_ptr<ChangeHooks> hooks = nullptr);

}  // namespace mauve::daemon
