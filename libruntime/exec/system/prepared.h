// SPDX-License-Identifier: LGPL-3.0-or-later
/// The result of prepare(), for commit().
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "exec/system/resource_parts.h"

#include <mauve/host/change.h>
#include <mauve/host/prepared_change.h>
#include <mauve/host/retired.h>

namespace mauve {
class Architecture;
}

namespace mauve::exec {

/// How a component takes part in a change.
enum class Part : std::uint8_t {
  changes,
  joins,
  leaves,
  follows,  ///< stays as it is, and is rolled back with the others: see inherit.h
};

/// Where a member is rolled back to.
struct Origin {
  std::shared_ptr<const Bundle> bundle;
  Mode mode = Mode::keep;
  StatePolicy state = StatePolicy::keep;
  /// The bundle of a change in between, whose core has the state that the core of `bundle` gave
  /// away, since no later core gives it back. Null: the core in force does, or it was never given.
  std::shared_ptr<const Bundle> state_kept = nullptr;
};

/// The change of one component, ready to be published.
struct PreparedMember {
  ComponentBase* component = nullptr;
  std::shared_ptr<ComponentBase> owner;  ///< keeps a component that joins, or has left
  Part part = Part::changes;
  std::shared_ptr<const Bundle> base;  ///< the bundle that it was prepared against
  std::optional<ComponentType> type;   ///< of a newer build, else as it is
  std::shared_ptr<const Bundle> next;  ///< the same as `base` when only the mode changes
  Mode mode = Mode::keep;
  StatePolicy state = StatePolicy::keep;
  bool restart = false;
  bool count_gap = false;
  std::uint64_t ends_stop = 0;  ///< it starts, although this stop by a user and older ones stand
  bool resume = false;          ///< in place: it ran before it was parked
  bool keeps_fault = false;     ///< in place: one that fails before it is parked stays faulted
  bool restores = false;  ///< in place: back to the core before, so a faulted component runs again
  Retired made;           ///< its new elements, cleaned up and freed unless they get in force
  /// The standby core that takes over when `next` fails, from its first job on; null: none.
  std::shared_ptr<PreparedChange::Content> standby;
};

/// The change of one resource: another core, other connections of its own ports, or another lock
/// budget.
struct PreparedResource {
  ResourceBase* resource = nullptr;
  ResourceParts base;   ///< the parts that it was prepared against
  ResourceParts parts;  ///< null: stays
  Duration base_lock_budget{0};
  std::optional<Duration> lock_budget;  ///< none: stays
  StatePolicy state = StatePolicy::keep;
  Retired made;
};

/// The additional parts of a change at a barrier.
struct PreparedBarrier {
  /// A resource that joins under the name of one that leaves.
  struct Replacement {
    ResourceBase* from = nullptr;
    ResourceParts base;  ///< the parts of `from` when the change was prepared
    Duration base_lock_budget{0};
    ResourceBase* into = nullptr;
    StatePolicy state = StatePolicy::keep;
  };
  struct Wait {
    std::string component;
    std::uint64_t releases = 0;  ///< that it may lose, judged by its jobs so far
  };
  std::vector<Replacement> replacements;
  std::vector<Wait> waits;  ///< of all that run and would wait
};

/// A part of a change that leaves everything as it is but for the mode.
[[nodiscard]] PreparedMember member_of(ComponentBase& component, Mode mode);

/// Other code, not just another object: another class, or the same one of another build.
/// Measurements of the one do not hold for the other.
[[nodiscard]] bool is_other_code(const Configurable& before, const Configurable& after);

/// Keeps alive all that the content refers to.
[[nodiscard]] PreparedChange make_prepared(const Architecture& architecture,
                                           std::unique_ptr<PreparedChange::Content> content);

}  // namespace mauve::exec

namespace mauve {

/// Freed from the last member to the first: connections go before the resources they lead to.
class PreparedChange::Content {
 public:
  /// The elements that it changes stay alive with it: a rollback may take them out meanwhile. Those
  /// that its connections lead to stay alive with the prepared change only.
  std::vector<std::shared_ptr<void>> alive;
  std::vector<std::shared_ptr<ResourceBase>> new_resources;
  std::vector<ResourceBase*> leaving_resources;
  std::vector<std::shared_ptr<ResourceBase>> left_resources;
  std::vector<exec::PreparedMember> members;
  std::vector<exec::PreparedResource> resources;
  /// Of the model that it was prepared against, see System::revision; none: it has no preparation.
  std::optional<std::uint64_t> revision;
  std::optional<std::uint64_t> made_from;  ///< see Change
  std::string what;                        ///< in the words of the wire
  std::vector<std::string> sets;           ///< addresses of properties that it sets
  std::optional<Probation> probation;
  bool changes_rules = false;  ///< see Change
  bool ends_stops = false;     ///< see Change
  std::vector<std::string> stops = {};
  UserStop stopped_by = {};
  std::vector<std::string> newly_stopped = {};  ///< of `stops`, against which no stop stood before
  std::uint64_t last_stop = 0;                  ///< the number of the last one of `stops`
  std::set<std::string> ended_stops = {};  ///< of these components: its rollback brings them back
  bool in_place = false;  ///< elements in force are cleaned up before those that come are used
  bool step = false;      ///< makes no generation: the last step of its change does, or none
  std::vector<NewFallback> fallbacks;
  std::optional<exec::PreparedBarrier> barrier;  ///< none: the cut
  std::vector<std::string> warnings;             ///< for the receipt
};

}  // namespace mauve
