// SPDX-License-Identifier: LGPL-3.0-or-later
/// What a system still does when the process must die of a fault.
#pragma once

#include "exec/system/system.h"

namespace mauve::exec {

/// From now on; until System::last_words is reset. Nothing where signals cannot be handled.
Status prepare_last_words(System& system);

}  // namespace mauve::exec
