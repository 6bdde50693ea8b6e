// SPDX-License-Identifier: LGPL-3.0-or-later
/// The way of every change: prepared on [factory], committed on [control], what it replaced freed
/// on [factory]; the answer goes out as soon as it is in force.
#pragma once

#include <functional>
#include <string>

#include "commands/command.h"

namespace mauve::daemon {

/// [control] Takes over the call and the ticket: answers with the receipt or the refusal.
void apply(Running& running, const CallPtr& call, Ticket ticket, Change change);

/// [control] The same for a swap in place: the component is parked while the cores are exchanged.
void apply_in_place(Running& running, const CallPtr& call, Ticket ticket, Edit edit);

/// [control] Makes the running system what an architecture file says, in one change. Takes over the
/// call and the ticket.
void apply_architecture(Running& running, const CallPtr& call, Ticket ticket, std::string text,
                        std::string reason);

/// [control] Runs `then` on [control] when there is an answer; others are served meanwhile.
void when_answered(Running& running, std::shared_ptr<Ongoing> ongoing,
                   std::function<void(Ongoing&)> then);

/// What the system is in after a change that was refused with this.
[[nodiscard]] std::string state_after(const Error& error);

/// What a change of this component starts from.
[[nodiscard]] Edit edit_of(std::string_view component);

/// [any] "drop" or nothing; anything else is refused.
[[nodiscard]] Result<StatePolicy> state_policy(const Json& params);

}  // namespace mauve::daemon
