// SPDX-License-Identifier: LGPL-3.0-or-later
#include "arch/compare/describe.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>

#include "arch/compare/describe_rules.h"
#include "arch/parse/built_in.h"
#include "arch/parse/parts.h"
#include "arch/parse/spec.h"
#include "base/duration.h"
#include "base/size.h"
#include "mauve/host/architecture.h"
#include "plugin/load/catalog.h"
#include "plugin/load/loaded_plugin.h"

namespace mauve::arch {
namespace {

void add_if(Value::Object& object, bool wanted, std::string key, Value value) {
  if (wanted) object.emplace_back(std::move(key), std::move(value));
}

template <typename Container>
void add_unless_empty(Value::Object& object, std::string key, Container content) {
  if (!content.empty()) object.emplace_back(std::move(key), std::move(content));
}

Value::Object changed_properties(const Parts& parts) {
  Value::Object properties;
  for (const auto& [group, part] : parts) {
    for (const PropertyBase* property : part->properties()) {
      Value value = property->value();
      const bool changed = !value.is_null() && !(value == property->default_value());
      add_if(properties, changed, std::string(group) + "." + std::string(property->name()),
             std::move(value));
    }
  }
  return properties;
}

Value::Object connections(const Shell& shell, const Bindings& bindings) {
  Value::Object ports;
  for (const PortBase* port : shell.ports()) {
    if (port->index() >= bindings.size() || bindings[port->index()] == nullptr) continue;
    ports.emplace_back(std::string(port->name()),
                       describe_connection(bindings[port->index()].get()));
  }
  return ports;
}

Value::Object changed_attributes(const TaskAttributes& attributes) {
  const auto usual = describe_task(TaskAttributes{});
  Value::Object object;
  for (auto& [name, value] : describe_task(attributes)) {
    const auto same = std::pair(name, value);
    const bool changed = std::find(usual.begin(), usual.end(), same) == usual.end();
    add_if(object, changed && !value.is_null(), std::string(name), std::move(value));
  }
  return object;
}

// Zero is the word for "none", which the file does not write.
Value unless_zero(Duration duration) {
  return duration == Duration{0} ? Value() : Value(format_duration(duration));
}

Value overrun_limit(const TaskAttributes& attributes) {
  const bool counts =
      attributes.on_overrun == OnOverrun::stop || attributes.on_overrun == OnOverrun::fallback;
  if (!counts || attributes.overrun_limit == TaskAttributes{}.overrun_limit) return {};
  return static_cast<std::int64_t>(attributes.overrun_limit);
}

Value describe(const ResourceBase& resource) {
  Value::Object object{{"type", resource.type().name}};
  if (is_built_in(resource.type().name)) {
    object.emplace_back("data", resource.find_service("read")->signature().types);
  }
  Value::Object properties = changed_properties(parts_of(resource));
  Value::Object ports = connections(resource.shell(), resource.bindings());
  add_unless_empty(object, "properties", std::move(properties));
  add_unless_empty(object, "ports", std::move(ports));
  Value hold = describe_lock_budget(resource);
  add_if(object, !hold.is_null(), "lock_budget", std::move(hold));
  return object;
}

Value::Array requests(const ComponentBase& component, const rules::Supervision& supervision) {
  const auto found = supervision.may_request.find(component.name());
  if (found == supervision.may_request.end()) return {};
  return {found->second.begin(), found->second.end()};
}

Value describe(const ComponentBase& component, bool parked, Value::Array may_request) {
  const Bundle& bundle = *component.bundle();
  Value::Object object{{"type", component.type().name}, {"core", bundle.core_type.name}};
  // A plugin's component type registers its own state machine under its own name.
  add_if(object, bundle.fsm_type.name != component.type().name, "fsm", bundle.fsm_type.name);
  add_if(object, component.fallback().has_value(), "fallback_core",
         describe_fallback(component.fallback()));
  Value::Object properties = changed_properties(parts_of(component));
  Value::Object ports = connections(component.shell(), *bundle.bindings);
  Value::Object attributes = changed_attributes(bundle.task);
  add_unless_empty(object, "properties", std::move(properties));
  add_unless_empty(object, "ports", std::move(ports));
  add_unless_empty(object, "task", std::move(attributes));
  add_if(object, parked, "start", false);
  add_unless_empty(object, "may_request", std::move(may_request));
  return object;
}

Value::Array loaded_plugins(const plugin::Catalog& catalog) {
  Value::Array names;
  for (const plugin::LoadedPlugin* plugin : catalog.plugins()) {
    if (!plugin->info().file.empty()) names.emplace_back(plugin->info().name);
  }
  return names;
}

}  // namespace

std::vector<std::pair<std::string_view, Value>> describe_task(const TaskAttributes& attributes) {
  Value::Array cpus;
  for (const int cpu : attributes.cpus) cpus.emplace_back(cpu);
  return {{"priority", attributes.priority},
          {"cpus", cpus.empty() ? Value() : Value(std::move(cpus))},
          {"offset", unless_zero(attributes.offset)},
          {"deadline", unless_zero(attributes.deadline)},
          {"budget", unless_zero(attributes.budget)},
          {"stack", format_size(attributes.stack)},
          {"on_overrun", to_string(attributes.on_overrun)},
          {"overrun_limit", overrun_limit(attributes)},
          {"on_fault", describe_fault_policy(attributes.on_fault)},
          {"watchdog", unless_zero(attributes.watchdog)}};
}

Value describe_fault_policy(const FaultPolicy& policy) {
  if (policy.action != FaultPolicy::Action::restart) return to_string(policy.action);
  return Value::Object{{"restart", static_cast<std::int64_t>(policy.restarts)},
                       {"per", format_duration(policy.per)},
                       {"back_off", format_duration(policy.back_off)}};
}

Value describe_lock_budget(const ResourceBase& resource) {
  return unless_zero(resource.lock().budget());
}

Value describe_connection(const Binding* binding) {
  if (binding == nullptr) return {};
  std::string service = binding->service().address();
  if (binding->max_age() == Duration{0}) return service;
  return Value::Object{{"connect", std::move(service)},
                       {"max_age", format_duration(binding->max_age())}};
}

Value describe_fallback(const std::optional<ComponentBase::Fallback>& fallback) {
  if (!fallback) return {};
  if (fallback->properties.empty()) return fallback->core.name;
  return Value::Object{{"core", fallback->core.name},
                       {"properties", Value::Object(fallback->properties)}};
}

Value describe(const Architecture& architecture, const plugin::Catalog& catalog,
               const Parked& parked, const rules::Supervision& supervision,
               const std::vector<std::string>& lost) {
  Value::Object resources;
  for (const ResourceBase* resource : architecture.resources()) {
    resources.emplace_back(resource->name(), describe(*resource));
  }
  Value::Object components;
  for (const ComponentBase* component : architecture.components()) {
    const bool waits = parked ? parked(*component) : !component->task().start;
    components.emplace_back(component->name(),
                            describe(*component, waits, requests(*component, supervision)));
  }
  Value::Object file{{"schema", kSchema},
                     {"name", architecture.name()},
                     {"plugins", loaded_plugins(catalog)},
                     {"resources", std::move(resources)},
                     {"components", std::move(components)}};
  add_unless_empty(file, "transactions", describe_transactions(supervision));
  add_unless_empty(file, "rules", describe_rules(supervision));
  add_unless_empty(file, "lost", Value::Array(lost.begin(), lost.end()));
  return file;
}

}  // namespace mauve::arch
