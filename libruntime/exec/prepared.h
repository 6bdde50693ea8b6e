// SPDX-License-Identifier: LGPL-3.0-or-later
/// What prepare() leaves for commit().
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "exec/resource_flip.h"

#include <mauve/deployer.h>

namespace mauve::exec {

/// How a component takes part in a change.
enum class Part : std::uint8_t { changes, joins, leaves };

/// The change of one component, ready to be published.
struct PreparedMember {
  ComponentBase* component = nullptr;
  std::shared_ptr<ComponentBase> owner;  ///< of one that joins; of one that left, once it did
  Part part = Part::changes;
  std::shared_ptr<const Bundle> base;  ///< what it was prepared against
  std::optional<ComponentType> type;   ///< of a newer build, else as it is
  std::shared_ptr<const Bundle> next;  ///< the same as `base` when only the mode changes
  Mode mode = Mode::keep;
  StatePolicy state = StatePolicy::keep;
  bool restart = false;
  bool count_gap = false;
  bool resume = false;  ///< in place: it ran before it was parked
  Retired made;         ///< its new elements, cleaned up and freed unless they get in force
};

/// The change of one resource: another core, or other connections of its own ports.
struct PreparedResource {
  ResourceBase* resource = nullptr;
  ResourceParts base;   ///< what it was prepared against
  ResourceParts parts;  ///< null: stays
  StatePolicy state = StatePolicy::keep;
  Retired made;
};

}  // namespace mauve::exec

namespace mauve {

/// Freed from the last member to the first: connections go before the resources they lead to.
class PreparedChange::Content {
 public:
  std::vector<std::shared_ptr<ResourceBase>> new_resources;
  std::vector<ResourceBase*> leaving_resources;
  std::vector<std::shared_ptr<ResourceBase>> left_resources;
  std::vector<exec::PreparedMember> members;
  std::vector<exec::PreparedResource> resources;
  std::optional<Probation> probation;
  std::vector<std::string> warnings;  ///< for the receipt
};

}  // namespace mauve
