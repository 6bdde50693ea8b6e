// SPDX-License-Identifier: LGPL-3.0-or-later
/// Page faults of fresh code, caused here and not on a real-time thread.
#pragma once

namespace mauve::plugin {

/// Touches all pages of the shared object that holds `address`, writable ones for writing. Best
/// effort. [factory]
void prefault(const void* address);

}  // namespace mauve::plugin
