// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/job.h>

#include <mauve/clock.h>

namespace mauve {

Job& this_job() {
  // libmauve is loaded at start: its thread-local storage needs no allocation on first use.
  [[gnu::tls_model("initial-exec")]] static thread_local Job job;
  return job;
}

Instant job_time() {
  const Instant start = this_job().start;
  return start != 0 ? start : MonotonicClock().now();
}

Status refuse_in_job(const std::string& at, const char* what) {
  if (!this_job().running) return ok();
  return refuse(Errc::wrong_state, at, std::string(what) + " was called from a real-time job",
                "call it from a thread that is no component's");
}

}  // namespace mauve
