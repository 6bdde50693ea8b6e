// SPDX-License-Identifier: LGPL-3.0-or-later
/// Resources of a change: those that it changes, and those that join.
#pragma once

#include "exec/system/prepared.h"

#include <mauve/result.h>

namespace mauve::exec {

class Afterwards;

/// Can this be the longest time that the resource is held?
Status check_lock_budget(const ResourceBase& resource, Duration budget);

Status prepare_joining(const Afterwards& after, const NewResource& joining);

Result<PreparedResource> prepare_resource(const Afterwards& after, const Edit& edit,
                                          ResourceBase& resource);

}  // namespace mauve::exec
