// SPDX-License-Identifier: LGPL-3.0-or-later
/// Admission of the running system and of its changes, by the rule in DeployOptions::admission.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "exec/system/system.h"

#include <mauve/host/timing.h>

namespace mauve::exec {

/// Admits the system before its first release; a missing proof goes to the warnings of the system.
/// [control]
Status admit_deployment(System& system);

/// Admits a prepared change: the warnings for its receipt, or the first problem. A barrier only
/// moves releases apart, of members and of bystanders, so the proof for the cut holds for it.
/// [factory] or [control], under System::model.
[[nodiscard]] Result<std::vector<std::string>> admit_change(System& system,
                                                            const PreparedChange::Content& change);

/// May this standby core take over from the core that the change brings its component? By
/// Admission::strict only.
[[nodiscard]] bool admit_standby(System& system, const PreparedChange::Content& change,
                                 const PreparedMember& standby);

/// The timing of the running system. [control]
[[nodiscard]] Timing analyze(System& system);
/// The bound on the response of each component, where one is known.
struct Responses {
  std::map<std::string, Duration> bounds;
  bool measured = false;  ///< they rest on a measured time, which a job may exceed
};
/// A small part of the work of analyze(). [control]
[[nodiscard]] Responses responses(System& system);
/// The timing of an architecture that is not deployed, from its declared times. A component that
/// names no CPUs gets those that a deployer would choose. Its state machines are configured, and
/// cleaned up afterwards.
[[nodiscard]] Timing analyze(Architecture& architecture, const MachineCosts& machine);

}  // namespace mauve::exec
