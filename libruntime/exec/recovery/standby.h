// SPDX-License-Identifier: LGPL-3.0-or-later
/// Standby core: the core that takes over by itself when one fails: the fallback core of the file,
/// or a fresh one of the same kind. It is made and configured beforehand and stands by in the task,
/// which applies it at its next release, without [control].
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "exec/system/system.h"

#include <mauve/host/change.h>

namespace mauve::exec {

/// The changes that prepare the missing standby cores. A component has none without a policy, or
/// when its budget of restarts is used up. [control]
[[nodiscard]] std::vector<Change> wanted_standby_cores(System& system);

/// The edit that would replace the elements that this member of the change brings. Nothing: no
/// policy, or its elements stay as they are. [factory], under System::model
[[nodiscard]] std::optional<Edit> standby_of(System& system, const PreparedChange::Content& change,
                                             const PreparedMember& member);

/// The standby core that comes with a change: its task takes it together with the new bundle.
/// `restarts`: those there were.
[[nodiscard]] std::unique_ptr<TaskUpdate> make_standby(PreparedMember& standby,
                                                       std::size_t restarts);

/// Puts a prepared standby in readiness. [control]
void put_in_readiness(System& system, PreparedChange& prepared);

/// Enters standby cores that took over into the model, and reports them. A component whose core
/// failed, and for which no standby is wanted, parks as faulted, which is reported too. [control]
void look_after_standby_cores(System& system);

/// Some core still stands by for a bundle that its component does not run any more. [control]
[[nodiscard]] bool holds_stale_standby(const System& system);

/// No standby can be made for this component: if its core has failed, it parks as faulted.
/// [control]
void refuse_standby(System& system, std::string_view component, const std::string& why);

/// How a component recovers whose core failed at this instant. [control]
[[nodiscard]] Recovery recovery_of(const System& system, const Deployed& deployed,
                                   Instant failed_at);

/// An error of preparing this standby. A fallback core is named as such, since X.core runs.
[[nodiscard]] Error about_standby(const Change& standby, Error error);

}  // namespace mauve::exec
