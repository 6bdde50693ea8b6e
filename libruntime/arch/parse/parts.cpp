// SPDX-License-Identifier: LGPL-3.0-or-later
#include "arch/parse/parts.h"

#include <algorithm>

#include "mauve/fsm.h"
#include "mauve/host/component.h"
#include "mauve/host/resource.h"
#include "mauve/observable.h"
#include "mauve/property.h"
#include "mauve/shell.h"

namespace mauve::arch {
namespace {

// "core.gain" -> the core and "gain"; null for no or another part.
std::pair<Configurable*, std::string_view> split(const Parts& parts, std::string_view name) {
  const std::size_t dot = name.find('.');
  if (dot == std::string_view::npos) return {nullptr, {}};
  for (const auto& [group, part] : parts) {
    if (group == name.substr(0, dot)) return {part, name.substr(dot + 1)};
  }
  return {nullptr, {}};
}

}  // namespace

Parts parts_of(const ComponentBase& component) {
  return {{{"shell", &component.shell()}, {"core", &component.core()}, {"fsm", &component.fsm()}}};
}

Parts parts_of(const ResourceBase& resource) {
  return {{{"shell", &resource.shell()},
           {"core", &resource.core()},
           {"interface", &resource.interface()}}};
}

bool is_of_missing_part(const Parts& parts, std::string_view name) {
  return std::any_of(parts.begin(), parts.end(), [&](const auto& entry) {
    return entry.second == nullptr && name.substr(0, name.find('.')) == entry.first;
  });
}

PropertyBase* find_property(const Parts& parts, std::string_view name) {
  const auto [part, rest] = split(parts, name);
  return part == nullptr ? nullptr : part->find_property(rest);
}

ObservableBase* find_observable(const Parts& parts, std::string_view name) {
  const auto [part, rest] = split(parts, name);
  return part == nullptr ? nullptr : part->find_observable(rest);
}

std::vector<std::string> property_names(const Parts& parts) {
  std::vector<std::string> names;
  for (const auto& [group, part] : parts) {
    if (part == nullptr) continue;
    for (const PropertyBase* property : part->properties()) {
      names.push_back(std::string(group) + "." + std::string(property->name()));
    }
  }
  return names;
}

}  // namespace mauve::arch
