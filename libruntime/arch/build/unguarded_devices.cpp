// SPDX-License-Identifier: LGPL-3.0-or-later
#include "arch/build/unguarded_devices.h"

#include <algorithm>
#include <string>
#include <string_view>

#include <mauve/detail/port_base.h>
#include <mauve/detail/property_base.h>
#include <mauve/guarded.h>
#include <mauve/host/architecture.h>
#include <mauve/host/component.h>
#include <mauve/shell.h>

namespace mauve::arch {

std::vector<Wiring::Note> unguarded_devices(const Architecture& architecture) {
  std::vector<Wiring::Note> notes;
  for (const ComponentBase* component : architecture.components()) {
    const auto bundle = component->bundle();
    const PropertyBase* const device = bundle->core->find_property("device");
    if (device == nullptr || device->within().find("/dev/") == std::string_view::npos) continue;
    const auto& ports = bundle->shell->ports();
    const auto commanded = std::find_if(ports.begin(), ports.end(), [](const PortBase* port) {
      return port->signature().kind == PortKind::read && port->connected();
    });
    if (commanded == ports.end() || Guarded::declared_by(*bundle->core) ||
        Guarded::declared_by(*bundle->shell)) {
      continue;
    }
    notes.push_back(
        {device->address(),
         "the device is commanded by what " + std::string((*commanded)->name()) +
             " reads, and no order makes it safe when its component stops, fails or "
             "ends: declare a mauve::Guarded, or switch on the time-out of the device"});
  }
  return notes;
}

}  // namespace mauve::arch
