// SPDX-License-Identifier: LGPL-3.0-or-later
/// The expensive half of a pair of memory fences, so that real-time threads need no cheap one.
#pragma once

namespace mauve::rt {

/// Every thread of this process has passed a memory barrier when it returns: what one stored before
/// is seen here, and what this thread stored before is seen there (membarrier(2)). Where a filter
/// refuses the call it passes one itself and waits longer than any store takes. [guard, control]
void fence_all_threads();

}  // namespace mauve::rt
