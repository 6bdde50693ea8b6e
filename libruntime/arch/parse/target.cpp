// SPDX-License-Identifier: LGPL-3.0-or-later
#include "arch/parse/target.h"

#include "base/name.h"
#include "mauve/host/architecture.h"

namespace mauve::arch {

namespace {

std::vector<std::string> value_names(const Element& element) {
  const auto prefix = element.name() + ".";
  std::vector<std::string> names;
  for (const auto& [group, part] : element.parts()) {
    const auto dotted = prefix + std::string(group) + ".";
    for (const auto* property : part->properties()) {
      names.push_back(dotted + std::string(property->name()));
    }
    for (const auto* observable : part->observables()) {
      names.push_back(dotted + std::string(observable->name()));
    }
  }
  for (const auto* port : element.shell().ports()) {
    names.push_back(prefix + "ports." + std::string(port->name()));
  }
  if (element.resource != nullptr) {
    for (const auto* service : element.resource->interface().services()) {
      names.push_back(prefix + std::string(service->name()));
    }
  }
  return names;
}

/// Another core of the same component may have the value: the message names the one in force.
std::string nothing_of_this_name(const Element& element, std::string_view address) {
  const bool of_core = address.substr(element.name().size()).starts_with(".core.");
  if (!of_core || element.component == nullptr) return "there is nothing of this name";
  return "core " + element.component->bundle()->core_type.name +
         ", which is in force, has no value of this name";
}

Error unknown_value(const Element& element, std::string_view address) {
  auto hint = did_you_mean(address, value_names(element));
  if (hint.empty()) {
    hint = "mauvectl show " + element.name() + " lists what it has";
  }
  return refuse({Errc::unknown_name, "unknown_address"}, std::string(address.substr(0, 255)),
                nothing_of_this_name(element, address), std::move(hint));
}

}  // namespace

const std::string& Element::name() const {
  return component != nullptr ? component->name() : resource->name();
}

Parts Element::parts() const {
  return component != nullptr ? parts_of(*component) : parts_of(*resource);
}

Shell& Element::shell() const {
  return component != nullptr ? component->shell() : resource->shell();
}

const Bindings& Element::bindings() const {
  return component != nullptr ? *component->bundle()->bindings : resource->bindings();
}

namespace {

std::vector<std::string> component_names(const Architecture& architecture) {
  std::vector<std::string> names;
  for (const auto* component : architecture.components()) {
    names.push_back(component->name());
  }
  return names;
}

}  // namespace

Result<Element> find_element(const Architecture& architecture, std::string_view name) {
  const Element found{architecture.find_component(name), architecture.find_resource(name)};
  if (found.component != nullptr || found.resource != nullptr) {
    return found;
  }
  auto names = component_names(architecture);
  for (const auto* resource : architecture.resources()) {
    names.push_back(resource->name());
  }
  return refuse({Errc::unknown_name, "unknown_element"}, std::string(name.substr(0, 255)),
                "there is no component or resource of this name", known_names(name, names));
}

Result<ComponentBase*> find_component(const Architecture& architecture, std::string_view name) {
  auto element = find_element(architecture, name);
  if (!element) {
    return element.error();
  }
  if (element->component == nullptr) {
    return refuse({Errc::type_mismatch, "not_a_component"}, std::string(name),
                  "is a resource, not a component", "mauvectl list components");
  }
  return element->component;
}

Result<Target> find_target(const Architecture& architecture, std::string_view address) {
  const auto dot = address.find('.');
  const auto element = find_element(architecture, address.substr(0, dot));
  if (!element) {
    return element.error();
  }
  if (dot == std::string_view::npos) {
    return refuse({Errc::invalid_value, "no_own_value"}, std::string(address),
                  "has no value of its own",
                  "mauvectl show " + std::string(address) + " lists what it has");
  }
  const auto rest = address.substr(dot + 1);
  Target target{*element};
  constexpr std::string_view kPorts = "ports.";
  if (rest.starts_with(kPorts)) {
    target.port = element->shell().find_port(rest.substr(kPorts.size()));
  } else if (element->resource != nullptr && rest.find('.') == std::string_view::npos) {
    target.service = element->resource->find_service(rest);
  } else {
    target.property = find_property(element->parts(), rest);
    target.observable = find_observable(element->parts(), rest);
  }
  const bool found = target.port != nullptr || target.service != nullptr ||
                     target.property != nullptr || target.observable != nullptr;
  return found ? Result<Target>(target) : unknown_value(*element, address);
}

Result<std::pair<std::string, std::string>> split_port(std::string_view address) {
  const auto first = address.find('.');
  constexpr std::string_view kPorts = ".ports.";
  if (first == std::string_view::npos || !address.substr(first).starts_with(kPorts)) {
    return refuse({Errc::invalid_value, "not_a_port"}, std::string(address.substr(0, 255)),
                  "is no port", "a port is written COMPONENT.ports.NAME");
  }
  return std::pair{std::string(address.substr(0, first)),
                   std::string(address.substr(first + kPorts.size()))};
}

const Binding* connection(const Element& element, const PortBase& port) {
  const auto& bindings = element.bindings();
  return port.index() < bindings.size() ? bindings[port.index()].get() : nullptr;
}

}  // namespace mauve::arch
