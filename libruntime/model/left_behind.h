// SPDX-License-Identifier: LGPL-3.0-or-later
/// What a thread that hangs may still be looking at can never be freed. It is kept here, so that
/// it is no leak that nobody knows of.
#pragma once

#include <memory>

namespace mauve {

/// Keeps the object until the process ends. [any], not on a real-time thread.
void leave_behind(std::shared_ptr<const void> object);

}  // namespace mauve
