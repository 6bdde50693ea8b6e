// SPDX-License-Identifier: LGPL-3.0-or-later
/// What the records of a trace are about.
#pragma once

#include <mauve/trace.h>

namespace mauve::exec {

class System;

/// Deployer::traced(). [control]
[[nodiscard]] TracedSystem traced(System& system);

}  // namespace mauve::exec
