// SPDX-License-Identifier: LGPL-3.0-or-later
/// The state transfers of a barrier.
#pragma once

#include <vector>

#include "exec/system/prepared.h"

#include <mauve/result.h>

namespace mauve {
struct NewResource;
}  // namespace mauve

namespace mauve::exec {

class System;

/// The replacement of the resource that leaves under its name, before it is configured. Errors: as
/// plan_transfer().
Status prepare_replacement(System& system, const NewResource& joining,
                           PreparedChange::Content& content);

}  // namespace mauve::exec
