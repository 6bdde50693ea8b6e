// SPDX-License-Identifier: LGPL-3.0-or-later
#include "arch/build/unguarded_devices.h"

#include <string>

#include <mauve/detail/port_base.h>
#include <mauve/detail/property_base.h>
#include <mauve/guarded.h>
#include <mauve/host/architecture.h>
#include <mauve/host/component.h>
#include <mauve/shell.h>

#include "arch/parse/target.h"
#include "model/component/devices.h"

namespace mauve::arch {

namespace {

/// The read port whose values the core sends to its device; null: none is connected.
const PortBase* commanding(ComponentBase& component) {
  for (const PortBase* port : component.bundle()->shell->ports()) {
    const bool reads = port->signature().kind == PortKind::read;
    const bool connected =
        port->connected() || connection(Element{&component, nullptr}, *port) != nullptr;
    if (reads && connected) return port;
  }
  return nullptr;
}

}  // namespace

std::vector<Wiring::Note> unguarded_devices(const Architecture& architecture) {
  std::vector<Wiring::Note> notes;
  for (ComponentBase* component : architecture.components()) {
    const auto bundle = component->bundle();
    const PropertyBase* const device = device_of(*bundle->core);
    const PortBase* const port = commanding(*component);
    if (device == nullptr || port == nullptr || Guarded::declared_by(*bundle->core) ||
        Guarded::declared_by(*bundle->shell)) {
      continue;
    }
    notes.push_back(
        {device->address(),
         "obeys the values of port " + std::string(port->name()) +
             ", and nothing makes the device safe when its component stops, fails or ends: declare "
             "a mauve::Guarded, or switch on the time-out of the device"});
  }
  return notes;
}

}  // namespace mauve::arch
