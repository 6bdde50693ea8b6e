// SPDX-License-Identifier: LGPL-3.0-or-later
/// Whether a component is late by its own doing. [any]
#pragma once

#include "mauve/host/report.h"

namespace mauve::daemon {

/// Did a job of it use more processor time than its budget, or than its period? The time of other
/// threads that preempted the job does not count.
[[nodiscard]] inline bool own_job_too_long(const ComponentStatus& one) {
  const auto exceeds = [&](Duration limit) { return limit > Duration{0} && one.used_max > limit; };
  return exceeds(one.budget) || exceeds(one.period);
}

}  // namespace mauve::daemon
