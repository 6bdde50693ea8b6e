// SPDX-License-Identifier: LGPL-3.0-or-later
/// The expensive half of a pair of memory fences, so that real-time threads need no cheap one.
#pragma once

namespace mauve::rt {

/// Every thread of this process has passed a memory barrier when this function returns
/// (membarrier(2)). This thread sees the stores of the others before it, and they see the stores of
/// this thread before it. Where a filter refuses the call this thread passes a barrier itself and
/// waits longer than any store takes. [guard, control]
void fence_all_threads();

}  // namespace mauve::rt
