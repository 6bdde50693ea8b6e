// SPDX-License-Identifier: LGPL-3.0-or-later
/// The change of one resource, made beside the running one.
#include "exec/prepare/prepare_resource.h"
#include "base/duration.h"
#include "exec/prepare/afterwards.h"
#include "exec/prepare/edit_properties.h"
#include "model/element/elements.h"
#include "model/element/hand_over.h"
#include "model/port/connection.h"

#include <mauve/detail/job.h>
#include <mauve/host/resource.h>
#include <mauve/service.h>

namespace mauve::exec {
namespace {

Result<std::shared_ptr<const Bindings>> new_bindings(const Afterwards& after, const Edit& edit,
                                                     ResourceBase& resource) {
  std::shared_ptr<const Bindings> table = resource.shared_bindings();
  for (const std::string& port : edit.disconnect) {
    auto without = without_connection(resource.shell(), *table, port);
    if (!without) return without.error();
    table = *std::move(without);
  }
  for (const NewConnection& wanted : edit.connect) {
    const Result<ServiceBase*> service = after.find_service(wanted.service);
    if (!service) return service.error();
    auto with = with_connection(resource.shell(), *table, wanted.port, **service,
                                (*service)->resource().keep_alive(), wanted.max_age);
    if (!with) return with.error();
    table = *std::move(with);
  }
  return table;
}

/// The core anew, with other properties.
Status make_core(const Edit& edit, ResourceBase& resource, PreparedResource& prepared) {
  std::shared_ptr<CoreBase>& core = prepared.parts.core;
  Status done = check_whole(resource, edit.state);
  if (done) done = check_state_survives(resource.core(), edit);
  const CoreType& type = edit.core ? *edit.core : resource.type().core;
  if (done) done = make_element(resource.core().address(), type.make, core);
  if (done) done = prepare_hand_over(resource.core(), *core, edit.state);
  if (done) done = copy_properties(resource.core(), *core);
  if (done) done = set_properties(edit, "core", *core);
  if (!done) return done;
  core->bind(resource.shell());
  prepared.made.add(core);
  const NoPorts no_ports;
  return core->configure();
}

}  // namespace

Status check_lock_budget(const ResourceBase& resource, Duration budget) {
  const std::string at = resource.name() + ".lock_budget";
  if (budget < Duration{0} || budget > kLongestBudget) {
    return refuse({Errc::invalid_value, "value_out_of_range"}, at,
                  "must be between 0 and " + format_duration(kLongestBudget),
                  "0 takes the declaration back");
  }
  if (!resource.lock().timed()) {
    return refuse({Errc::unsupported, "attribute_not_applicable"}, at,
                  "has no meaning here: it is held for some stores only, and not counted");
  }
  return ok();
}

Result<PreparedResource> prepare_resource(const Afterwards& after, const Edit& edit,
                                          ResourceBase& resource) {
  if (edit.mode != Mode::keep || edit.core || edit.fsm || edit.task) {
    return refuse({Errc::unsupported, "resource_has_no_thread"}, edit.member,
                  "is a resource: it has no thread to start or stop, and its core is replaced by "
                  "changing its properties only");
  }
  if (Status paths = check_paths(edit, {"shell", "core", "interface"}); !paths)
    return paths.error();
  PreparedResource prepared;
  prepared.resource = &resource;
  prepared.base = {resource.shared_core(), resource.shared_bindings()};
  prepared.base_lock_budget = resource.lock().budget();
  prepared.lock_budget = edit.lock_budget;
  prepared.state = edit.state;
  if (edit.lock_budget) {
    if (Status sound = check_lock_budget(resource, *edit.lock_budget); !sound) return sound.error();
  }
  if (!edit.connect.empty() || !edit.disconnect.empty()) {
    auto bindings = new_bindings(after, edit, resource);
    if (!bindings) return bindings.error();
    prepared.parts.bindings = *std::move(bindings);
  }
  if (edit.properties.empty()) return prepared;
  if (Status made = make_core(edit, resource, prepared); !made) {
    static_cast<void>(drop_elements(resource.name(), [&] { prepared = {}; }));
    return made.error();
  }
  return prepared;
}

Status prepare_joining(const Afterwards& after, const NewResource& joining) {
  ResourceBase& resource = *joining.resource;
  const NoPorts no_ports;
  if (Status configured = resource.configure(); !configured) return configured;
  for (const NewConnection& wanted : joining.connect) {
    const Result<ServiceBase*> service = after.find_service(wanted.service);
    if (!service) return service.error();
    Status done = resource.connect(wanted.port, **service, (*service)->resource().keep_alive(),
                                   wanted.max_age);
    if (!done) return done;
  }
  return ok();
}

}  // namespace mauve::exec
