// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/detail/job.h>

#include <mauve/host/clock.h>

namespace mauve {

namespace detail {

constinit thread_local Job job;

Instant time_outside_jobs() { return MonotonicClock().now(); }

}  // namespace detail

Status refuse_in_job(const std::string& at, const char* what) {
  if (!this_job().running) return ok();
  return refuse({Errc::wrong_state, "called_from_job"}, at,
                std::string(what) + " was called from a real-time job",
                "call it from a thread that is no component's");
}

}  // namespace mauve
