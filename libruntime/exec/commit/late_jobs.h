// SPDX-License-Identifier: LGPL-3.0-or-later
/// Why members do not end their jobs in time: their threads run, sleep, or get no processor.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "exec/run/runner.h"
#include "exec/system/system.h"

namespace mauve::exec {

/// The hint of a refusal by a component that did not come in time.
inline constexpr const char* kHoldsUp =
    "mauvectl why NAME says whether its job does not end, or its thread gets no processor";

/// A part of a refusal: how the thread of a job spent the time that a change waited for it.
[[nodiscard]] std::string reason_of_delay(Duration ran, bool asleep, Duration waited);

/// Made when a change begins to wait for its members. [control]
class LateJobs {
 public:
  LateJobs(const Runner& runner, const std::vector<Deployed*>& members);

  /// The end of the sentence of a refusal: "; its thread ran for 1998 ms of the last 2000 ms, ...".
  /// Empty where time is simulated.
  [[nodiscard]] std::string reason(const std::vector<Deployed*>& silent) const;

 private:
  [[nodiscard]] std::string reason(const Deployed& member) const;

  const Runner& runner_;
  Instant since_;
  std::map<const Task*, Duration> ran_before_;
};

}  // namespace mauve::exec
