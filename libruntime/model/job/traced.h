// SPDX-License-Identifier: LGPL-3.0-or-later
/// The trace ring in which the code of a job records its actions.
#pragma once

#include "rt/ring/trace_ring.h"

#include <mauve/detail/job.h>
#include <mauve/trace.h>

namespace mauve {

/// The ring of this job while so much is traced; null: not so much is traced, or the thread was
/// abandoned and has no part in its component any more. [rt]
[[nodiscard]] inline rt::TraceRing* ring_of(const Job& job, TraceMode needed) {
  if (!detail::traces(needed) || job.has_no_ports()) return nullptr;
  return job.trace;
}

}  // namespace mauve
