// SPDX-License-Identifier: LGPL-3.0-or-later
/// The last actions of a system when the process must die of a fault.
#pragma once

#include "exec/system/system.h"

namespace mauve::exec {

/// Starts the crash handler, which lives until System::crash_handler is reset. Does nothing where
/// signals cannot be handled.
Status prepare_crash_handler(System& system);

}  // namespace mauve::exec
