// SPDX-License-Identifier: LGPL-3.0-or-later
/// DeployOptions: the conditions on which a deployer insists.
#pragma once

#include <cstdint>
#include <string>

#include <mauve/host/machine.h>

namespace mauve {

class UserStops;

/// The reaction when the process may not use SCHED_FIFO or lock memory.
enum class Realtime : std::uint8_t {
  require,  ///< refuse to deploy
  prefer,   ///< run without, and warn once (`Deployer::warnings`)
  off,      ///< ordinary threads
};

/// The reaction when it is not proved that every job meets its deadline. The proof is due at
/// deployment and before each change, for the change at any instant and for the rollback from it.
enum class Admission : std::uint8_t {
  strict,  ///< refuse; the error names the job and the smallest relaxation
  warn,    ///< go on, and warn (`Deployer::warnings`, `Receipt::warnings`)
  off,     ///< do not look
};

/// How a Deployer runs its architecture.
struct DeployOptions {
  Realtime realtime = Realtime::prefer;  ///< see there
  /// No threads: the caller moves a manual clock with run_for(), jobs run in its own thread in the
  /// order of release and priority.
  bool simulated = false;
  Admission admission = Admission::warn;  ///< see there
  MachineCosts machine = {};              ///< the costs that admission assumes
  std::uint64_t first_generation = 1;     ///< the number after deploy(); each change adds one
  /// The stops of users, also of before the deployment: they stand. The list outlives the deployer,
  /// which adds its own stops. Null: the deployer has a list of its own.
  UserStops* stops = nullptr;
};

}  // namespace mauve
