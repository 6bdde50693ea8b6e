// SPDX-License-Identifier: LGPL-3.0-or-later
/// What a prepared change would make different, in the lines of a comparison of two files.
#pragma once

#include <vector>

#include "arch/diff.h"
#include "mauve/deployer.h"

namespace mauve::daemon {

/// [control] Between prepare and commit. Elements that a change makes anew without another value
/// have no line.
[[nodiscard]] std::vector<arch::Line> foreseen(const PreparedChange::Content& change);

}  // namespace mauve::daemon
