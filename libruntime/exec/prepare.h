// SPDX-License-Identifier: LGPL-3.0-or-later
/// Step 1 of a change: everything slow, and everything that can fail, beside the running system.
#pragma once

#include <string_view>

#include "exec/prepared.h"
#include "exec/system.h"

namespace mauve::exec {

/// What there will be after the change, for everything that is connected by name. [factory]
class Afterwards {
 public:
  Afterwards(System& system, const Change& change) : system_(system), change_(change) {}

  /// Of what stays or joins.
  [[nodiscard]] Result<ServiceBase*> find_service(std::string_view address) const;
  [[nodiscard]] bool leaves(std::string_view name) const;
  /// May a thread have this priority here?
  [[nodiscard]] Status may_run_at(int priority) const;

 private:
  System& system_;
  const Change& change_;
};

/// Can this be the longest time that the resource is held?
Status check_hold(const ResourceBase& resource, Duration hold);

Result<PreparedMember> prepare_member(const Afterwards& after, const Edit& edit,
                                      ComponentBase& component, bool configure);
/// What takes over from what this member brings, made from that.
Result<PreparedMember> prepare_relief(const Afterwards& after, const Edit& edit,
                                      const PreparedMember& brings);
/// Connects and configures what joins; nobody uses it yet.
Result<PreparedMember> prepare_joining(const Afterwards& after, const NewComponent& joining);
Status prepare_joining(const Afterwards& after, const NewResource& joining);
Result<PreparedResource> prepare_resource(const Afterwards& after, const Edit& edit,
                                          ResourceBase& resource);

/// Keeps alive all that the content refers to.
PreparedChange make_prepared(const Architecture& architecture,
                             std::unique_ptr<PreparedChange::Content> content);

}  // namespace mauve::exec
