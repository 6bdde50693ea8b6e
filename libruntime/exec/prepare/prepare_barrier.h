// SPDX-License-Identifier: LGPL-3.0-or-later
/// What is handed over at a barrier.
#pragma once

#include <vector>

#include "exec/system/prepared.h"

#include <mauve/result.h>

namespace mauve {
struct NewResource;
}  // namespace mauve

namespace mauve::exec {

class System;

/// The heir of what leaves under its name, before it is configured. Errors: as plan_succession().
Status prepare_heir(System& system, const NewResource& joining, PreparedChange::Content& content);

}  // namespace mauve::exec
