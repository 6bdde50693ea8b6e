// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/prepare/prepare_barrier.h"

#include "exec/system/system.h"
#include "model/element/state_transfer.h"

#include <mauve/detail/port_base.h>
#include <mauve/fsm.h>
#include <mauve/host/architecture.h>
#include <mauve/host/resource.h>

namespace mauve::exec {
Status prepare_replacement(System& system, const NewResource& joining,
                           PreparedChange::Content& content) {
  const auto& leaving = content.leaving_resources;
  ResourceBase* const from = system.architecture.find_resource(joining.resource->name());
  if (std::find(leaving.begin(), leaving.end(), from) == leaving.end()) return ok();
  ResourceBase& into = *joining.resource;
  if (!into.made()) return into.made();
  const auto plan = plan_transfer(*from, into, joining.state, content.probation.has_value());
  if (!plan) return plan.error();
  if (Status slow = prepare_hand_over(from->core(), into.core(), joining.state); !slow) return slow;
  content.barrier->replacements.push_back({from,
                                           {from->shared_core(), from->shared_bindings()},
                                           from->lock().budget(),
                                           &into,
                                           joining.state});
  return ok();
}

}  // namespace mauve::exec
