// SPDX-License-Identifier: LGPL-3.0-or-later
/// Components of a change: those that it changes, and those that join.
#pragma once

#include "exec/system/prepared.h"

#include <mauve/result.h>

namespace mauve::exec {

class Afterwards;

Result<PreparedMember> prepare_member(const Afterwards& after, const Edit& edit,
                                      ComponentBase& component, bool configure);

/// The standby core for the elements that this member brings, made from them.
Result<PreparedMember> prepare_standby(const Afterwards& after, const Edit& edit,
                                       const PreparedMember& brings);

/// Connects and configures a component that joins; no thread uses it yet.
Result<PreparedMember> prepare_joining(const Afterwards& after, const NewComponent& joining);

}  // namespace mauve::exec
