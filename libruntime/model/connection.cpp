// SPDX-License-Identifier: LGPL-3.0-or-later
#include "model/connection.h"

#include <map>
#include <string>
#include <utility>

#include "base/name.h"

namespace mauve {
namespace {

std::vector<std::string> port_names(const Shell& shell) {
  std::vector<std::string> names;
  for (const PortBase* port : shell.ports()) names.emplace_back(port->name());
  return names;
}

Result<PortBase*> find_port(const Shell& shell, std::string_view name) {
  if (PortBase* port = shell.find_port(name)) return port;
  std::string owner = shell.address().substr(0, shell.address().rfind('.'));
  const std::string nearest = nearest_name(name, port_names(shell));
  return refuse(Errc::unknown_name, owner + ".ports." + std::string(name),
                owner + " has no port of this name",
                nearest.empty() ? "" : "did you mean " + owner + ".ports." + nearest + "?");
}

/// Depth-first walk along "writes on into"; the path is what a thread would hold.
class Walk {
 public:
  /// As if `from` wrote on into `into`.
  Status visit_from(const ResourceBase& from, const ResourceBase& into) {
    path_.push_back(&from);
    return follow(into);
  }
  Status visit(const ResourceBase& resource) {
    if (done_[&resource]) return ok();
    path_.push_back(&resource);
    if (path_.size() > Job::kMaxHeld) {
      return refuse(Errc::limit, resource.name(),
                    "resources nest deeper than " + std::to_string(Job::kMaxHeld));
    }
    for (const auto& binding : resource.bindings()) {
      if (binding == nullptr) continue;
      if (Status step = follow(binding->service().resource()); !step) return step;
    }
    path_.pop_back();
    done_[&resource] = true;
    return ok();
  }

 private:
  Status follow(const ResourceBase& next) {
    for (std::size_t i = 0; i < path_.size(); ++i) {
      if (path_[i] == &next) return cycle(i);
    }
    return visit(next);
  }
  Error cycle(std::size_t first) const {
    std::string text;
    for (std::size_t i = first; i < path_.size(); ++i) text += path_[i]->name() + " -> ";
    return refuse(Errc::cycle, path_[first]->name(),
                  "resources would wait for each other for ever: " + text + path_[first]->name(),
                  "disconnect one of these ports");
  }

  std::vector<const ResourceBase*> path_;
  std::map<const ResourceBase*, bool> done_;
};

}  // namespace

Status check_connection(const PortBase& port, const Binding* present, const ServiceBase& service,
                        Duration max_age) {
  if (present != nullptr) {
    return refuse(Errc::duplicate, port.address(),
                  "is connected to " + present->service().address() + " already",
                  "disconnect it first");
  }
  if (!(port.signature() == service.signature())) {
    const bool same_name = port.signature().kind == service.signature().kind &&
                           port.signature().types == service.signature().types;
    return refuse(Errc::type_mismatch, port.address(),
                  "is a " + to_string(port.signature()) + " port, but " + service.address() +
                      " is a " + to_string(service.signature()) + " service" +
                      (same_name ? " with another layout" : ""),
                  same_name ? "rebuild both plugins with the same headers" : "");
  }
  if (max_age < Duration{0} || (max_age > Duration{0} && port.signature().kind != PortKind::read)) {
    return refuse(Errc::invalid_value, port.address(),
                  max_age < Duration{0} ? "max_age must not be negative"
                                        : "max_age has no meaning here: only read ports have it");
  }
  return ok();
}

Result<std::shared_ptr<const Bindings>> with_connection(const Shell& shell, const Bindings& table,
                                                        std::string_view name, ServiceBase& service,
                                                        std::shared_ptr<void> keep_alive,
                                                        Duration max_age) {
  const Result<PortBase*> port = find_port(shell, name);
  if (!port) return port.error();
  const std::size_t index = (*port)->index();
  if (Status fits = check_connection(**port, table[index].get(), service, max_age); !fits) {
    return fits.error();
  }
  auto changed = std::make_shared<Bindings>(table);
  (*changed)[index] = std::make_shared<const Binding>(service, std::move(keep_alive), max_age);
  return std::shared_ptr<const Bindings>(std::move(changed));
}

Result<std::shared_ptr<const Bindings>> without_connection(const Shell& shell,
                                                           const Bindings& table,
                                                           std::string_view name) {
  const Result<PortBase*> port = find_port(shell, name);
  if (!port) return port.error();
  const std::size_t index = (*port)->index();
  if (table[index] == nullptr) {
    return refuse(Errc::wrong_state, (*port)->address(), "is not connected");
  }
  auto changed = std::make_shared<Bindings>(table);
  (*changed)[index] = nullptr;
  return std::shared_ptr<const Bindings>(std::move(changed));
}

std::shared_ptr<const Bindings> with_initial(Shell& shell, const Bindings& table) {
  auto changed = std::make_shared<Bindings>(table);
  for (std::size_t i = 0; i < changed->size(); ++i) {
    auto& initial = shell.initial_bindings()[i];
    if (initial != nullptr) (*changed)[i] = std::exchange(initial, nullptr);
  }
  return changed;
}

Status check_nesting(const ResourceBase& from, const ResourceBase& into) {
  Walk walk;
  return walk.visit_from(from, into);
}

Status check_resource_graph(const Architecture& architecture) {
  Walk walk;
  for (const ResourceBase* resource : architecture.resources()) {
    if (Status sound = walk.visit(*resource); !sound) return sound;
  }
  return ok();
}

}  // namespace mauve
