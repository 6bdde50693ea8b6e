// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/prepare/renew.h"

#include <algorithm>
#include <array>
#include <utility>

#include "exec/prepare/edit_properties.h"
#include "exec/prepare/prepare.h"
#include "exec/prepare/prepare_resource.h"
#include "exec/system/prepared.h"

#include <mauve/host/architecture.h>

namespace mauve::exec {
namespace {

using Renewed = std::vector<std::pair<const ResourceBase*, Edit>>;

bool contains(const std::vector<std::string>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Does the edit itself connect or disconnect this port?
bool speaks_of(const Edit& edit, std::string_view port) {
  return contains(edit.disconnect, port) ||
         std::any_of(edit.connect.begin(), edit.connect.end(),
                     [&](const NewConnection& wanted) { return wanted.port == port; });
}

Renewed take_renewed(const Architecture& architecture, Change& change) {
  Renewed renewed;
  std::erase_if(change.edits, [&](Edit& edit) {
    const ResourceBase* resource = architecture.find_resource(edit.member);
    const bool anew = resource != nullptr &&
                      (edit.resource || touches(edit, "shell") || touches(edit, "interface"));
    if (anew) renewed.emplace_back(resource, std::move(edit));
    return anew;
  });
  return renewed;
}

std::vector<NewConnection> connections_after(const ResourceBase& resource, const Edit& edit) {
  std::vector<NewConnection> after = edit.connect;
  for (const PortBase* port : resource.shell().ports()) {
    const auto& binding = resource.bindings()[port->index()];
    if (binding == nullptr || speaks_of(edit, port->name())) continue;
    after.push_back({std::string(port->name()), binding->service().address(), binding->max_age()});
  }
  return after;
}

Status copy_all(const ResourceBase& from, const ResourceBase& into, const Edit& edit) {
  using Part = std::pair<std::string_view, std::pair<const Configurable*, Configurable*>>;
  const std::array<Part, 3> parts{{{"shell", {&from.shell(), &into.shell()}},
                                   {"core", {&from.core(), &into.core()}},
                                   {"interface", {&from.interface(), &into.interface()}}}};
  for (const auto& [name, part] : parts) {
    Status done = copy_properties(*part.first, *part.second);
    if (done) done = set_properties(edit, name, *part.second);
    if (!done) return done;
  }
  return ok();
}

Status make_replacement(const ResourceBase& resource, const Edit& edit, Change& change) {
  if (edit.mode != Mode::keep || edit.core || edit.fsm || edit.type || edit.task) {
    return refuse({Errc::unsupported, "resource_has_no_thread"}, edit.member,
                  "is a resource: it has no thread, and its core comes with its type");
  }
  if (Status paths = check_paths(edit, {"shell", "core", "interface"}); !paths) return paths;
  auto replacement = std::make_shared<ResourceBase>(
      resource.name(), edit.resource ? *edit.resource : resource.type());
  if (!replacement->made()) return replacement->made();
  if (edit.lock_budget) {
    if (Status sound = check_lock_budget(*replacement, *edit.lock_budget); !sound) return sound;
  }
  change.new_resources.push_back({replacement, connections_after(resource, edit), edit.state});
  change.remove.push_back(resource.name());
  replacement->lock().set_budget(edit.lock_budget.value_or(resource.lock().budget()));
  return copy_all(resource, *replacement, edit);
}

Edit& edit_of(const std::string& name, Change& change) {
  const auto found = std::find_if(change.edits.begin(), change.edits.end(),
                                  [&](const Edit& edit) { return edit.member == name; });
  if (found != change.edits.end()) return *found;
  change.edits.emplace_back().member = name;
  return change.edits.back();
}

void connect_anew(const std::string& user, const Shell& shell, const Bindings& bindings,
                  const Renewed& renewed, Change& change) {
  if (contains(change.remove, user)) return;
  for (const PortBase* port : shell.ports()) {
    const auto& binding = bindings[port->index()];
    const bool leads =
        binding != nullptr && std::any_of(renewed.begin(), renewed.end(), [&](const auto& one) {
          return one.first == &binding->service().resource();
        });
    if (!leads) continue;
    Edit& edit = edit_of(user, change);
    if (speaks_of(edit, port->name())) continue;
    edit.disconnect.emplace_back(port->name());
    edit.connect.push_back(
        {std::string(port->name()), binding->service().address(), binding->max_age()});
  }
}

}  // namespace

Status put_as_replacements(const Architecture& architecture, Change& change) {
  const Renewed renewed = take_renewed(architecture, change);
  if (renewed.empty()) return ok();
  change.sync = Sync::barrier;
  for (const auto& [resource, edit] : renewed) {
    if (Status made = make_replacement(*resource, edit, change); !made) return made;
  }
  for (const ComponentBase* user : architecture.components()) {
    connect_anew(user->name(), user->shell(), *user->bundle()->bindings, renewed, change);
  }
  for (const ResourceBase* user : architecture.resources()) {
    connect_anew(user->name(), user->shell(), user->bindings(), renewed, change);
  }
  return ok();
}

}  // namespace mauve::exec
