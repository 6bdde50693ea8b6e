// SPDX-License-Identifier: LGPL-3.0-or-later
/// architecture.graph: all elements and connections in one look, for pictures.
#include "arch/built_in.h"
#include "commands/machine.h"
#include "commands/value.h"

namespace mauve::daemon {

namespace {

/// Of shared data only: other services would run their core for it.
Json status_of(const Running& running, const Element& element, PortBase& port,
               const Binding& binding) {
  if (port.signature().kind != PortKind::read ||
      binding.service().resource().type().name != arch::kSharedData) {
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
    const auto* binding = connection(element, *port);
    Json row = {{"name", port->name()},
                {"kind", to_string(port->signature().kind)},
                {"type", port->signature().types},
                {"service", binding == nullptr ? Json() : Json(binding->service().address())}};
    if (binding != nullptr) {
      row["status"] = status_of(running, element, *port, *binding);
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

Json services_of(const ResourceBase& resource) {
  Json rows = Json::array();
  for (const auto* service : resource.interface().services()) {
    rows.push_back({{"name", service->name()},
                    {"kind", to_string(service->signature().kind)},
                    {"type", service->signature().types}});
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
                         {"poisoned", resource->gate().poisoned()},
                         {"services", services_of(*resource)},
                         {"ports", ports_of(running, {nullptr, resource})}});
  }
  return Json{{"generation", running.earlier + running.deployer.generation()},
              {"architecture", running.architecture.name()},
              {"components", std::move(components)},
              {"resources", std::move(resources)}};
}

Json machine_json(const FsmBase& fsm) {
  Json states = Json::array();
  for (const auto* state : fsm.states()) {
    const bool waits = state->kind() == FsmState::Kind::synchronization;
    Json row = {{"name", state->name()}, {"kind", waits ? "synchronization" : "execution"}};
    if (waits) {
      row["wait_ns"] = state->duration().count();
    }
    Json transitions = Json::array();
    for (const auto& transition : state->transitions()) {
      transitions.push_back({{"to", transition.target->name()}, {"guarded", true}});
    }
    if (state->successor() != nullptr) {
      transitions.push_back({{"to", state->successor()->name()}, {"guarded", false}});
    }
    row["transitions"] = std::move(transitions);
    states.push_back(std::move(row));
  }
  const auto* initial = fsm.initial();
  return {{"initial", initial == nullptr ? Json() : Json(initial->name())},
          {"states", std::move(states)}};
}

}  // namespace mauve::daemon
