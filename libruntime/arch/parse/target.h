// SPDX-License-Identifier: LGPL-3.0-or-later
/// Finding things of an architecture by their address. [control]
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "arch/parse/parts.h"
#include "mauve/detail/binding.h"
#include "mauve/result.h"

namespace mauve {
class Architecture;
class ComponentBase;
class ObservableBase;
class PortBase;
class PropertyBase;
class ResourceBase;
class ServiceBase;
class Shell;
}  // namespace mauve

namespace mauve::arch {

/// A component or a resource.
struct Element {
  ComponentBase* component = nullptr;
  ResourceBase* resource = nullptr;

  [[nodiscard]] const std::string& name() const;
  [[nodiscard]] Parts parts() const;
  [[nodiscard]] Shell& shell() const;
  [[nodiscard]] const Bindings& bindings() const;
};

/// "control" -> the element, or unknown_name with the nearest one.
[[nodiscard]] Result<Element> find_element(const Architecture& architecture, std::string_view name);
[[nodiscard]] Result<ComponentBase*> find_component(const Architecture& architecture,
                                                    std::string_view name);

/// The thing that an address of a value names; exactly one member is set.
struct Target {
  Element element;
  PropertyBase* property = nullptr;
  ObservableBase* observable = nullptr;
  PortBase* port = nullptr;
  ServiceBase* service = nullptr;
};

/// "control.core.gain", "gnss.core.bad_frames", "control.ports.scan", "scan.read".
[[nodiscard]] Result<Target> find_target(const Architecture& architecture,
                                         std::string_view address);

/// "control.ports.scan" -> element and name of the port, which need not exist.
[[nodiscard]] Result<std::pair<std::string, std::string>> split_port(std::string_view address);

/// The connection of a port, or null.
[[nodiscard]] const Binding* connection(const Element& element, const PortBase& port);

}  // namespace mauve::arch
