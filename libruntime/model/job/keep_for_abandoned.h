// SPDX-License-Identifier: LGPL-3.0-or-later
/// An abandoned thread may use its objects at any time, so they are never freed. They are kept
/// here, where a leak checker finds them.
#pragma once

#include <memory>

namespace mauve {

/// Keeps the object until the process ends. [any], but on no real-time thread.
void keep_for_abandoned(std::shared_ptr<const void> object);

}  // namespace mauve
