// SPDX-License-Identifier: LGPL-3.0-or-later
#include "model/port/connection.h"

#include <string>
#include <utility>

#include "base/name.h"

#include <mauve/detail/port_base.h>
#include <mauve/service.h>
#include <mauve/shell.h>

namespace mauve {
namespace {

std::vector<std::string> port_names(const Shell& shell) {
  std::vector<std::string> names;
  for (const PortBase* port : shell.ports()) names.emplace_back(port->name());
  return names;
}

}  // namespace

Result<PortBase*> find_port(const Shell& shell, std::string_view name) {
  if (PortBase* port = shell.find_port(name)) return port;
  std::string owner = shell.address().substr(0, shell.address().rfind('.'));
  const std::string nearest = nearest_name(name, port_names(shell));
  return refuse({Errc::unknown_name, "unknown_port"}, owner + ".ports." + std::string(name),
                owner + " has no port of this name",
                nearest.empty() ? "" : "did you mean " + owner + ".ports." + nearest + "?");
}

Status check_connection(const PortBase& port, const Binding* present, const ServiceBase& service,
                        Duration max_age) {
  if (!(port.signature() == service.signature())) {
    const bool same_name = port.signature().kind == service.signature().kind &&
                           port.signature().types == service.signature().types;
    return refuse({Errc::type_mismatch, "port_does_not_fit"}, port.address(),
                  "is a " + to_string(port.signature()) + " port, but " + service.address() +
                      " is a " + to_string(service.signature()) + " service" +
                      (same_name ? " with another layout" : ""),
                  same_name ? "rebuild all plugins that use the type with the same header; a type "
                              "whose layout was changed gets the next revision in its type_name"
                            : "");
  }
  if (present != nullptr) {
    return refuse({Errc::duplicate, "port_connected"}, port.address(),
                  "is connected to " + present->service().address() + " already",
                  "disconnect it first");
  }
  if (max_age < Duration{0} || (max_age > Duration{0} && port.signature().kind != PortKind::read)) {
    return refuse({Errc::invalid_value, "max_age_invalid"}, port.address(),
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
    return refuse({Errc::wrong_state, "port_not_connected"}, (*port)->address(),
                  "is not connected");
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

}  // namespace mauve
