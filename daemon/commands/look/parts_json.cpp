// SPDX-License-Identifier: LGPL-3.0-or-later
#include <algorithm>
#include <iterator>

#include "commands/look/parts_json.h"

#include "base/thread_role.h"

#include "arch/build/unguarded_devices.h"
#include "arch/parse/built_in.h"
#include "mauve/detail/port_base.h"
#include "mauve/host/resource.h"
#include "mauve/service.h"
#include "model/component/wiring.h"

namespace mauve::daemon {

Json port_row(const Element& element, const PortBase& port) {
  const auto* binding = connection(element, port);
  return {{"name", port.name()},
          {"kind", to_string(port.signature().kind)},
          {"type", port.signature().types},
          {"service", binding == nullptr ? Json() : Json(binding->service().address())}};
}

bool reads_shared_data(const Element& element, const PortBase& port) {
  const auto* binding = connection(element, port);
  return binding != nullptr && port.signature().kind == PortKind::read &&
         binding->service().resource().type().name == arch::kSharedData;
}

Json service_row(const ServiceBase& service) {
  return {{"name", service.name()},
          {"kind", to_string(service.signature().kind)},
          {"type", service.signature().types}};
}

Json service_rows(const ResourceBase& resource) {
  Json rows = Json::array();
  for (const auto* service : resource.interface().services()) {
    rows.push_back(service_row(*service));
  }
  return rows;
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
      transitions.push_back({{"to", transition.target->name()},
                             {"guarded", true},
                             {"guard", transition.name.empty() ? Json() : Json(transition.name)}});
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

Json wiring_notes(const Running& running) {
  MAUVE_ON_THREAD(control);
  Json rows = Json::array();
  auto notes = Wiring(running.architecture).notes();
  std::ranges::move(arch::unguarded_devices(running.architecture), std::back_inserter(notes));
  for (const auto& note : notes) {
    rows.push_back({{"address", note.address}, {"text", note.text}});
  }
  return rows;
}

}  // namespace mauve::daemon
