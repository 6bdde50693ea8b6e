// SPDX-License-Identifier: LGPL-3.0-or-later
/// The running job, as the code of a component or resource sees it: its time, and whether there is
/// one.
#pragma once

#include <mauve/detail/job.h>
#include <mauve/time.h>

namespace mauve {

/// Time for stamps: the start of the running job, or the clock outside one. All calls in one job
/// return the same time. [any]
[[nodiscard]] inline Instant job_time() {
  const Instant start = this_job().start;
  return start != 0 ? start : detail::time_outside_jobs();
}

/// The sampling interval of an integrator or a derivative: the time from the release of the
/// component's job before to the release of the running one. It lies on the grid of releases, so it
/// is free of jitter; it follows a change of the period, and it is longer where releases were
/// missed. In the first job after a start it is the shortest wait of the state machine. Zero
/// outside a job. [any]
[[nodiscard]] inline Duration time_step() { return this_job().step; }

/// True while the calling thread runs a job of a component, also in the resources that the job
/// uses; false in hooks and on threads of a driver. [any]
[[nodiscard]] inline bool in_job() { return this_job().running; }

}  // namespace mauve
