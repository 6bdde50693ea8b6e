// SPDX-License-Identifier: LGPL-3.0-or-later
#include "arch/build/shared_devices.h"

#include <map>
#include <string>
#include <string_view>

#include <mauve/detail/property_base.h>
#include <mauve/host/architecture.h>
#include <mauve/host/component.h>
#include <mauve/host/value.h>

namespace mauve::arch {

std::vector<Wiring::Note> shared_devices(const Architecture& architecture) {
  std::vector<Wiring::Note> notes;
  std::map<std::string, std::string> opened;  // by which property
  for (const ComponentBase* component : architecture.components()) {
    const auto bundle = component->bundle();
    const PropertyBase* const device = bundle->core->find_property("device");
    if (device == nullptr || device->within().find("/dev/") == std::string_view::npos) continue;
    const Value value = device->value();
    const auto* const path = value.get_if<std::string>();
    if (path == nullptr || path->empty()) continue;
    const auto [first, is_first] = opened.try_emplace(*path, device->address());
    if (is_first) continue;
    notes.push_back({device->address(), "names the same device as " + first->second + ", " + *path +
                                            ": of two drivers each overrules the other, or takes "
                                            "its bytes"});
  }
  return notes;
}

}  // namespace mauve::arch
