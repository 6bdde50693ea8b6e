// SPDX-License-Identifier: LGPL-3.0-or-later
#include <mauve/host/architecture.h>

#include <algorithm>
#include <set>

#include "base/name.h"
#include "model/component/wiring.h"
#include "model/element/find_named.h"
#include "model/job/guard.h"
#include "model/port/connection.h"
#include "model/resource/resource_graph.h"

namespace mauve {
namespace {

template <typename Names, typename Items>
void collect_names(Names& names, const Items& items) {
  for (const auto* item : items) names.emplace_back(item->name());
}

template <typename Base>
std::shared_ptr<Base> take(std::vector<Base*>& all, std::vector<std::shared_ptr<Base>>& owned,
                           Base& element) {
  std::erase(all, &element);
  const auto found = std::find_if(owned.begin(), owned.end(),
                                  [&](const auto& owner) { return owner.get() == &element; });
  if (found == owned.end()) return nullptr;
  std::shared_ptr<Base> owner = std::move(*found);
  owned.erase(found);
  return owner;
}

template <typename Base>
std::shared_ptr<void> owner_in(const std::vector<std::shared_ptr<Base>>& owned,
                               const Base& element) {
  const auto found = std::find_if(owned.begin(), owned.end(),
                                  [&](const auto& one) { return one.get() == &element; });
  return found == owned.end() ? nullptr : *found;
}

}  // namespace

Architecture::~Architecture() {
  // Members of a derived class are gone by now, each cleaned up by its own destructor.
  while (!owned_components_.empty()) owned_components_.pop_back();
  while (!owned_resources_.empty()) owned_resources_.pop_back();
}

ComponentBase* Architecture::find_component(std::string_view name) const {
  return find_named(components_, name);
}

ResourceBase* Architecture::find_resource(std::string_view name) const {
  return find_named(resources_, name);
}

Result<ServiceBase*> Architecture::find_service(std::string_view address) const {
  const auto dot = address.find('.');
  const std::string_view owner = address.substr(0, dot);
  ResourceBase* resource = find_resource(owner);
  if (resource == nullptr) {
    std::vector<std::string> names;
    collect_names(names, resources_);
    return refuse({Errc::unknown_name, "unknown_element"}, std::string(address),
                  "there is no resource " + std::string(owner), known_names(owner, names));
  }
  const std::string_view name = dot == std::string_view::npos ? "" : address.substr(dot + 1);
  if (ServiceBase* service = resource->find_service(name)) return service;
  std::vector<std::string> names;
  for (const ServiceBase* service : resource->interface().services()) {
    names.push_back(service->address());
  }
  return refuse({Errc::unknown_name, "unknown_service"}, std::string(address),
                "resource " + resource->name() + " has no service of this name",
                known_names(address, names));
}

ComponentBase& Architecture::own(std::shared_ptr<ComponentBase> component) {
  add(*component);
  owned_components_.push_back(std::move(component));
  return *components_.back();
}

ResourceBase& Architecture::own(std::shared_ptr<ResourceBase> resource) {
  add(*resource);
  owned_resources_.push_back(std::move(resource));
  return *resources_.back();
}

std::shared_ptr<ComponentBase> Architecture::take_out(ComponentBase& component) {
  return take(components_, owned_components_, component);
}

std::shared_ptr<ResourceBase> Architecture::take_out(ResourceBase& resource) {
  return take(resources_, owned_resources_, resource);
}

std::shared_ptr<void> Architecture::owner_of(const ComponentBase& component) const {
  return owner_in(owned_components_, component);
}

std::shared_ptr<void> Architecture::owner_of(const ResourceBase& resource) const {
  return owner_in(owned_resources_, resource);
}

std::vector<std::shared_ptr<void>> Architecture::owners() const {
  std::vector<std::shared_ptr<void>> owners(owned_resources_.begin(), owned_resources_.end());
  owners.insert(owners.end(), owned_components_.begin(), owned_components_.end());
  return owners;
}

Status Architecture::configure() {
  if (configured_) return ok();
  std::set<std::string> names;
  std::vector<std::string> all;
  collect_names(all, components_);
  collect_names(all, resources_);
  for (const std::string& name : all) {
    if (!names.insert(name).second)
      return refuse({Errc::duplicate, "name_in_use"}, name, "this name is used twice");
  }
  // The hook uses the elements, so an element that could not be made is refused before it runs.
  for (const ResourceBase* resource : resources_) {
    if (!resource->made()) return resource->made();
  }
  for (const ComponentBase* component : components_) {
    if (!component->made()) return component->made();
  }
  Status done = call_hook(name_, "on_configure", [this] { return on_configure(); });
  for (ResourceBase* resource : resources_) {
    if (done) done = resource->configure();
  }
  if (done) done = ResourceGraph(*this).check();
  for (ComponentBase* component : components_) {
    if (done) done = component->configure();
  }
  if (done) done = Wiring(*this).check();  // connections that are made in code are in force now
  configured_ = true;
  if (!done) static_cast<void>(cleanup());
  return done;
}

Status Architecture::cleanup() {
  if (!configured_) return ok();
  configured_ = false;
  Status first = ok();
  for (auto it = components_.rbegin(); it != components_.rend(); ++it) {
    Status done = (*it)->cleanup();
    if (first && !done) first = std::move(done);
  }
  for (auto it = resources_.rbegin(); it != resources_.rend(); ++it) {
    Status done = (*it)->cleanup();
    if (first && !done) first = std::move(done);
  }
  return first;
}

}  // namespace mauve
