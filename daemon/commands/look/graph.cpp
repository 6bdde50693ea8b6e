// SPDX-License-Identifier: LGPL-3.0-or-later
/// architecture.graph: all elements and connections in one look, for pictures.
#include "commands/look/parts_json.h"
#include "commands/look/value.h"
#include "mauve/detail/port_base.h"
#include "mauve/host/architecture.h"

namespace mauve::daemon {

namespace {

/// Of shared data only: other services would run their core for it.
Json status_of(const Running& running, const Element& element, PortBase& port) {
  if (!reads_shared_data(element, port)) {
    return nullptr;
  }
  arch::Quantity quantity;
  quantity.target = {element, nullptr, nullptr, &port};
  quantity.aspect = arch::Quantity::Aspect::status;
  const auto status = read(running, quantity);
  const auto* word = status ? status->get_if<std::string>() : nullptr;
  return word == nullptr ? Json() : Json(*word);
}

Json ports_of(const Running& running, const Element& element) {
  Json rows = Json::array();
  for (auto* port : element.shell().ports()) {
    auto row = port_row(element, *port);
    if (connection(element, *port) != nullptr) {
      row["status"] = status_of(running, element, *port);
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace

Result<Json> graph(Running& running, const Call& /*call*/) {
  Json components = Json::array();
  for (auto* component : running.architecture.components()) {
    const auto status = running.deployer.status(component->name());
    components.push_back({{"name", component->name()},
                          {"type", component->type().name},
                          {"core", component->bundle()->core_type.name},
                          {"fsm", component->bundle()->fsm_type.name},
                          {"fsm_state", status.fsm_state},
                          {"state", to_string(status.state)},
                          {"ports", ports_of(running, {component, nullptr})}});
  }
  Json resources = Json::array();
  for (auto* resource : running.architecture.resources()) {
    resources.push_back({{"name", resource->name()},
                         {"type", resource->type().name},
                         {"poisoned", resource->lock().poisoned()},
                         {"services", service_rows(*resource)},
                         {"ports", ports_of(running, {nullptr, resource})}});
  }
  return Json{{"generation", running.deployer.generation()},
              {"architecture", running.architecture.name()},
              {"components", std::move(components)},
              {"resources", std::move(resources)},
              {"notes", wiring_notes(running)}};
}

}  // namespace mauve::daemon
