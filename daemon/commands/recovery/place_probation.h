// SPDX-License-Identifier: LGPL-3.0-or-later
/// The probation of a swap in place. Both cores want the same device, so the core before cannot
/// stand ready. When the new core fails, its component has its safe values until [factory] has
/// configured the core before again.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mauve/host/component.h"
#include "mauve/host/probation.h"
#include "mauve/host/report.h"
#include "mauve/result.h"

namespace mauve {
struct Bundle;
struct Change;
}  // namespace mauve

namespace mauve::daemon {

struct Running;
struct Call;

/// The past of a component before its core changed. One that is faulted stays so until it is
/// started, with any core, so its failure is not one of the new core.
struct FailureMark {
  std::string component;
  std::optional<Instant> before = std::nullopt;  ///< none: it was neither faulted nor recovering
  std::uint64_t implausible = 0;                 ///< values that its ports did not let out
  bool hands_over_implausible = false;  ///< some of the core before, whose state the new one takes
};

/// [control] Recorded before the change is in force.
[[nodiscard]] FailureMark mark_failure(const Running& running, const std::string& component);

/// [control] The failure of a core that came into force after the mark; none: it has not failed.
[[nodiscard]] std::optional<Incident> failure_since(const Running& running,
                                                    const FailureMark& mark);

/// The core that a swap in place replaced.
struct CoreBefore {
  std::shared_ptr<const Bundle> bundle;
  std::optional<ComponentType> type = {};  ///< of its component; none: the swap leaves it as it is
  bool ran = false;                        ///< the component ran until the swap
  FailureMark failure;
};

/// The new core of a swap in place failed, no user confirmed it, or a user takes the swap back.
struct PlaceFailure {
  std::string reason;
  std::optional<Incident> incident;  ///< none: it did not fail
  std::uint64_t stops = 0;           ///< of its component so far
};

/// A swap in place that has not proved itself. [control]
struct PlaceProbation {
  std::uint64_t generation = 0;  ///< that it made
  std::string component;
  Probation rules;
  std::chrono::steady_clock::time_point since;
  std::uint64_t releases = 0;  ///< of the component when it began
  CoreBefore before;
  std::shared_ptr<const Bundle> now;
  std::optional<PlaceFailure> failure = {};  ///< the first one; nothing that comes later hides it
  bool rolls_back = false;
};

/// [control] The swap in place is in force, and made this generation.
void begin_place_probation(Running& running, Call& call, std::uint64_t generation,
                           const std::string& component, CoreBefore before, const Probation& rules);

/// [control] Some times a second: whether a swap in place has failed, proved itself, or was
/// overtaken by a newer change of its component.
void look_at_places(Running& running);

/// [control] Looks for failures that a stop would hide. Call it before a component is stopped.
void note_place_failures(Running& running);

/// [control] A user confirms the swaps in place. A swap whose core has failed is not confirmed: its
/// rollback goes on. False: no swap in place was open.
[[nodiscard]] bool confirm_places(Running& running);

/// Names a swap in place, and the core that its rollback leads to.
struct PlaceTarget {
  std::uint64_t generation = 0;
  std::string component;
  std::weak_ptr<const Bundle> before;
};

/// [control] The newest one, if it is newer than the generation `than`.
[[nodiscard]] std::optional<PlaceTarget> newest_place(const Running& running, std::uint64_t than,
                                                      std::uint64_t generation = 0);

/// [control] Begins to put the core before in force again; the log shows `reason`. The log, the
/// audit log and the history record the end of the rollback, as they do for every probation. The
/// call is refused while another change is being prepared.
[[nodiscard]] Status undo_place(Running& running, const PlaceTarget& target,
                                const std::string& reason);

/// [control] After the rollback: whether the core before has taken over.
[[nodiscard]] Status is_back(const Running& running, const PlaceTarget& target);

/// [control] Some swap in place is being rolled back.
[[nodiscard]] bool places_roll_back(const Running& running);

/// [control] This component was swapped in place, and its core before takes over if it fails: no
/// other core stands by for it.
[[nodiscard]] bool is_place(const Running& running, const std::string& component);

/// [control] The generation of the oldest one that is open; 0: there is none.
[[nodiscard]] std::uint64_t oldest_place(const Running& running);

/// [control] Sentences on the ones that a change of these components ends early.
[[nodiscard]] std::vector<std::string> place_notes(const Running& running, const Change& change);

}  // namespace mauve::daemon
