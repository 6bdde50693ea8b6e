// SPDX-License-Identifier: LGPL-3.0-or-later
/// What prepare() leaves for commit().
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <mauve/deployer.h>

namespace mauve::exec {

/// The change of one component, ready to be published.
struct PreparedMember {
  ComponentBase* component = nullptr;
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
  std::shared_ptr<CoreBase> core;  ///< null: stays
  std::vector<NewConnection> connect;
  std::vector<std::string> disconnect;
  StatePolicy state = StatePolicy::keep;
  Retired made;
};

}  // namespace mauve::exec

namespace mauve {

class PreparedChange::Content {
 public:
  std::vector<exec::PreparedMember> members;
  std::vector<exec::PreparedResource> resources;
};

}  // namespace mauve
