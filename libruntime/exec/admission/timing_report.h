// SPDX-License-Identifier: LGPL-3.0-or-later
/// The response time analysis as a user reads it: rows, notes and sentences.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/admission.h"
#include "exec/admission/timing_model.h"
#include "exec/system/system.h"

#include <mauve/host/timing.h>

namespace mauve::exec {

[[nodiscard]] std::string sentence(const Error& error);
[[nodiscard]] std::vector<std::string> sentences(const std::vector<analysis::Problem>& problems);

/// The response time of the job with the least slack, where it is known.
[[nodiscard]] std::optional<Duration> response_of(const analysis::TaskReport& task);

/// The assumed costs of the machine, in words.
[[nodiscard]] std::string assumption_of(const MachineCosts& machine);

/// The results of the model for its components, and the behaviour of the machine. [control]
[[nodiscard]] Timing report_of(const System& system, const TimingModel& model);

}  // namespace mauve::exec
