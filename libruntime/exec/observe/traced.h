// SPDX-License-Identifier: LGPL-3.0-or-later
/// The components and other objects that the records of a trace refer to.
#pragma once

#include <mauve/trace.h>

namespace mauve::exec {

class System;

/// Deployer::traced(). [control]
[[nodiscard]] TracedSystem traced(System& system);

}  // namespace mauve::exec
