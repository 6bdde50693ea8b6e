// SPDX-License-Identifier: LGPL-3.0-or-later
/// Lines of the log about what may happen again and again: at its 1st, 10th, 100th time.
#pragma once

#include <string>

#include "monitor/milestones.h"

namespace mauve {
class Shell;
}

namespace mauve::daemon {

struct Running;

/// [control]
class RepeatedReports {
 public:
  /// Locks that were held for longer than their budget.
  void report_locks(Running& running);
  /// Budgets that were exceeded, schedulings that were put back, and values that were not
  /// plausible.
  void report_components(Running& running);

 private:
  void report_ports(Running& running, const std::string& component, const Shell& shell);

  Milestones held_too_long_;  ///< by resource
  Milestones over_budget_;    ///< by component
  Milestones restored_;       ///< by component
  Milestones implausible_;    ///< by port
};

}  // namespace mauve::daemon
