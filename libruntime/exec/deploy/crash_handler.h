// SPDX-License-Identifier: LGPL-3.0-or-later
/// The last actions of a system when the process must die of a fault.
#pragma once

#include "exec/system/system.h"

namespace mauve::exec {

/// From now on; until System::crash_handler is reset. Nothing where signals cannot be handled.
Status prepare_crash_handler(System& system);

}  // namespace mauve::exec
