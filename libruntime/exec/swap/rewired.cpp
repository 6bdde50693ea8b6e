// SPDX-License-Identifier: LGPL-3.0-or-later
#include "exec/swap/rewired.h"

#include "base/thread_role.h"

#include <algorithm>
#include <set>

#include "model/resource/resource_graph.h"

#include <mauve/detail/binding.h>
#include <mauve/detail/port_base.h>
#include <mauve/host/architecture.h>
#include <mauve/host/component.h>
#include <mauve/host/resource.h>
#include <mauve/interface.h>
#include <mauve/service.h>
#include <mauve/shell.h>

namespace mauve::exec {
namespace {

using Content = PreparedChange::Content;
using Services = std::set<const ServiceBase*>;

void put(Wiring& wiring, const ResourceBase& resource, const Bindings& bindings) {
  wiring.put(resource.name(), resource.shell(), bindings);
}

void put(Wiring& wiring, const ComponentBase& component, const Bundle& bundle) {
  wiring.put(component.name(), bundle);
}

void go_forth(Wiring& wiring, const Content& change) {
  for (const ResourceBase* leaving : change.leaving_resources) wiring.remove(leaving->name());
  for (const PreparedMember& one : change.members) {
    if (one.part == Part::leaves) wiring.remove(one.component->name());
  }
  for (const auto& joining : change.new_resources) put(wiring, *joining, joining->bindings());
  for (const PreparedResource& one : change.resources) {
    if (one.parts.bindings != nullptr) put(wiring, *one.resource, *one.parts.bindings);
  }
  for (const PreparedMember& one : change.members) {
    if (one.part != Part::leaves && one.next != nullptr) put(wiring, *one.component, *one.next);
  }
}

void go_back(Wiring& wiring, const Content& change) {
  for (const auto& joined : change.new_resources) wiring.remove(joined->name());
  for (const PreparedMember& one : change.members) {
    if (one.part == Part::joins) wiring.remove(one.component->name());
  }
  for (const ResourceBase* left : change.leaving_resources) put(wiring, *left, left->bindings());
  for (const PreparedResource& one : change.resources) {
    if (one.base.bindings != nullptr) put(wiring, *one.resource, *one.base.bindings);
  }
  for (const PreparedMember& one : change.members) {
    if (one.part != Part::joins && one.base != nullptr) put(wiring, *one.component, *one.base);
  }
}

bool leaves(const Content& content, const ResourceBase* resource) {
  const auto& leaving = content.leaving_resources;
  return std::find(leaving.begin(), leaving.end(), resource) != leaving.end();
}

const PreparedMember* prepared_of(const Content& content, const ComponentBase& component) {
  const auto found = std::find_if(content.members.begin(), content.members.end(),
                                  [&](const auto& one) { return one.component == &component; });
  return found == content.members.end() ? nullptr : &*found;
}

bool leaves(const Content& content, const ComponentBase& component) {
  const PreparedMember* const member = prepared_of(content, component);
  return member != nullptr && member->part == Part::leaves;
}

/// The connections of the resource after the change.
const Bindings& bindings_after(const Content& content, const ResourceBase& resource) {
  for (const PreparedResource& changed : content.resources) {
    if (changed.resource == &resource && changed.parts.bindings != nullptr) {
      return *changed.parts.bindings;
    }
  }
  return resource.bindings();
}

/// An element of this name is there, and stays.
bool is_in_use(const Architecture& architecture, const Content& content, const std::string& name) {
  const ComponentBase* const component = architecture.find_component(name);
  ResourceBase* const resource = architecture.find_resource(name);
  return (component != nullptr && !leaves(content, *component)) ||
         (resource != nullptr && !leaves(content, resource));
}

Status check_names(const Architecture& architecture, const Content& content) {
  std::vector<std::string> joining;
  for (const auto& resource : content.new_resources) joining.push_back(resource->name());
  for (const PreparedMember& member : content.members) {
    if (member.part == Part::joins) joining.push_back(member.component->name());
  }
  for (const std::string& name : joining) {
    if (!is_in_use(architecture, content, name)) continue;
    return refuse({Errc::duplicate, "name_in_use"}, name, "there is something of this name already",
                  "choose another name, or remove the other one in the same change");
  }
  return ok();
}

void add_services(const ResourceBase& resource, Services& services) {
  for (const ServiceBase* service : resource.interface().services()) services.insert(service);
}

/// The services before or after a change. A connection is compared with them by address alone,
/// since the service that it leads to may be gone.
class Reachable {
 public:
  Reachable(const Architecture& architecture, const Content& content) {
    for (ResourceBase* resource : architecture.resources()) {
      add_services(*resource, leaves(content, resource) ? leaving_ : there_);
    }
    for (const auto& resource : content.new_resources) add_services(*resource, there_);
  }

  /// Does each connection of these ports lead to a service that is there after the change?
  /// `before`: connections that the change does not make, which may lead out of the architecture.
  Status check(const std::string& owner, const Shell& shell, const Bindings& bindings,
               const Bindings& before) const {
    for (const PortBase* port : shell.ports()) {
      const auto& binding = bindings[port->index()];
      if (binding == nullptr || there_.contains(&binding->service())) continue;
      const bool leaves = leaving_.contains(&binding->service());
      if (!leaves && std::find(before.begin(), before.end(), binding) != before.end()) continue;
      const std::string address = owner + ".ports." + std::string(port->name());
      if (leaves) {
        return refuse({Errc::wrong_state, "connection_left_over"}, address,
                      "is connected to " + binding->service().address() +
                          ", which is to be removed or made anew",
                      "disconnect it, or connect it elsewhere, in the same change");
      }
      return refuse({Errc::wrong_state, "connection_left_over"}, address,
                    "would be connected to a service that is gone",
                    "look at `graph`, then connect it to one that is there");
    }
    return ok();
  }

 private:
  Services there_;
  Services leaving_;
};

Status check_connections(const Architecture& architecture, const Content& content) {
  const Reachable services(architecture, content);
  for (const ComponentBase* component : architecture.components()) {
    if (prepared_of(content, *component) != nullptr) continue;
    const auto bundle = component->bundle();
    const Bindings& own = *bundle->bindings;
    Status sound = services.check(component->name(), *bundle->shell, own, own);
    if (!sound) return sound;
  }
  for (const PreparedMember& member : content.members) {
    if (member.part == Part::leaves) continue;
    const Bundle& next = *member.next;
    const Bindings before = member.base == nullptr ? Bindings() : *member.base->bindings;
    Status sound = services.check(member.component->name(), *next.shell, *next.bindings, before);
    if (!sound) return sound;
  }
  std::vector<const ResourceBase*> resources(architecture.resources().begin(),
                                             architecture.resources().end());
  for (const auto& joining : content.new_resources) resources.push_back(joining.get());
  for (const ResourceBase* resource : resources) {
    if (leaves(content, resource)) continue;
    Status sound = services.check(resource->name(), resource->shell(),
                                  bindings_after(content, *resource), resource->bindings());
    if (!sound) return sound;
  }
  return ok();
}

/// Checks all resources as they are after the change, since each edit alone may be sound.
Status check_nesting(const Architecture& architecture, const Content& content) {
  ResourceGraph graph(architecture);
  for (const ResourceBase* leaving : content.leaving_resources) graph.remove(*leaving);
  for (const auto& joining : content.new_resources) graph.put(*joining, joining->bindings());
  for (const PreparedResource& changed : content.resources) {
    if (changed.parts.bindings == nullptr) continue;
    graph.put(*changed.resource, *changed.parts.bindings);
  }
  return graph.check();
}

}  // namespace

Wiring rewired(const Architecture& architecture, const Content& change) {
  Wiring wiring(architecture);
  go_forth(wiring, change);
  return wiring;
}

bool clash(const Architecture& architecture, const Content& change, const Content& before) {
  MAUVE_ON_THREAD(control);
  Wiring wiring(architecture);
  go_back(wiring, before);
  go_forth(wiring, change);
  return !wiring.check();
}

/// The resources that the change edits or removes, and those whose connections lead to one of them.
/// The bindings of now suffice: a resource with new bindings is one that the change edits.
std::set<const ResourceBase*> resources_touched(const Architecture& architecture,
                                                const Content& change) {
  std::set<const ResourceBase*> resources(change.leaving_resources.begin(),
                                          change.leaving_resources.end());
  for (const PreparedResource& edited : change.resources) resources.insert(edited.resource);
  const auto leads_there = [&](const auto& binding) {
    return binding != nullptr && resources.contains(&binding->service().resource());
  };
  for (std::size_t before = 0; before != resources.size();) {
    before = resources.size();
    for (const ResourceBase* one : architecture.resources()) {
      const Bindings& bindings = one->bindings();
      if (std::any_of(bindings.begin(), bindings.end(), leads_there)) resources.insert(one);
    }
  }
  return resources;
}

Status check_fit(const Architecture& architecture, const Content& content) {
  Status sound = check_names(architecture, content);
  if (sound) sound = check_connections(architecture, content);
  if (sound) sound = check_nesting(architecture, content);
  return sound ? rewired(architecture, content).check() : sound;
}

}  // namespace mauve::exec
