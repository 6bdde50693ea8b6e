// SPDX-License-Identifier: LGPL-3.0-or-later
/// object.get and param.get: everything about one thing, and the value of one thing.
#include <initializer_list>

#include "arch/compare/describe.h"
#include "arch/text/value_json.h"
#include "base/duration.h"
#include "commands/answer.h"
#include "commands/look/parts_json.h"
#include "commands/look/value.h"
#include "commands/model.h"
#include "mauve/detail/port_base.h"
#include "mauve/host/architecture.h"
#include "mauve/host/resource.h"
#include "mauve/observable.h"
#include "mauve/service.h"
#include "mauve/slow_state.h"
#include "mauve/state.h"

namespace mauve::daemon {

namespace {

Json property_row(const std::string& name, const PropertyBase& property) {
  return {{"name", name},
          {"value", arch::to_json(property.value())},
          {"default", arch::to_json(property.default_value())},
          {"min", arch::to_json(property.min())},
          {"max", arch::to_json(property.max())},
          {"unit", property.unit()},
          {"type", property.type().name},
          {"text", property.text()}};
}

Json observable_row(const std::string& name, const ObservableBase& observable) {
  return {{"name", name},
          {"value", arch::to_json(observable.value())},
          {"unit", observable.unit()},
          {"type", observable.type().name},
          {"text", observable.text()}};
}

/// Facts that only a request for one element or port shows.
Json whole_port_row(const Element& element, const PortBase& port) {
  auto row = port_row(element, port);
  row["max_age"] = max_age_of(connection(element, port));
  if (port.signature().kind == PortKind::write) {
    row["safe_value"] = port.has_safe_value();
  }
  row["failures"] = port.failures();
  if (port.signature().kind == PortKind::write) {
    row["implausible"] = port.implausible().of_core;
  }
  return row;
}

/// Adds the fields of the answer of `get` for this address, where `get` has an answer.
void add_value(Json& object, const Running& running, const std::string& address,
               const Target& target, std::initializer_list<const char*> keys) {
  const auto now = sample(running, address, target);
  for (const auto* key : keys) {
    if (now && now->contains(key)) {
      object[key] = (*now)[key];
    }
  }
}

/// Of ports that read shared data also how fresh that is.
Json port_rows(const Running& running, const Element& element) {
  Json rows = Json::array();
  for (auto* port : element.shell().ports()) {
    auto row = whole_port_row(element, *port);
    if (reads_shared_data(element, *port)) {
      add_value(row, running, port->address(), {element, nullptr, nullptr, port},
                {"status", "age_ns"});
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

/// Of the part `only`; empty: of all parts.
void add_values(Json& object, const Element& element, std::string_view only) {
  Json properties = Json::array();
  Json observables = Json::array();
  for (const auto& [group, part] : element.parts()) {
    if (!only.empty() && group != only) {
      continue;
    }
    const auto prefix = std::string(group) + ".";
    for (const auto* property : part->properties()) {
      properties.push_back(property_row(prefix + std::string(property->name()), *property));
    }
    for (const auto* observable : part->observables()) {
      observables.push_back(observable_row(prefix + std::string(observable->name()), *observable));
    }
  }
  object["properties"] = std::move(properties);
  object["observables"] = std::move(observables);
}

void add_parts(Json& object, const Running& running, const Element& element) {
  add_values(object, element, {});
  object["ports"] = port_rows(running, element);
}

/// The states that a change hands over to the next core.
void add_states(Json& object, const CoreBase& core) {
  const auto add = [&object](const char* key, const Capsule* state) {
    if (state != nullptr) {
      object[key] = {{"type", state->type().name}, {"bytes", state->type().size}};
    }
  };
  add("core_state", core.declared_state());
  add("slow_state", core.declared_slow_state());
}

Json task_of(const TaskAttributes& task, const ComponentStatus& status) {
  return {{"priority", task.priority},
          {"cpus", status.cpus},
          {"offset", format_duration(task.offset)},
          {"deadline", format_duration(task.deadline)},
          {"budget", format_duration(task.budget)},
          {"stack", task.stack},
          {"on_overrun", to_string(task.on_overrun)},
          {"overrun_limit", task.overrun_limit},
          {"on_fault", arch::to_json(arch::describe_fault_policy(task.on_fault))},
          {"watchdog", format_duration(status.watchdog)},
          {"start", task.start}};
}

Json counters_of(const ComponentStatus& status) {
  return {{"releases", status.releases},
          {"missed", status.missed},
          {"overruns", status.overruns},
          {"over_budget", status.over_budget},
          {"implausible", status.implausible_of_core},
          {"late_ns", status.late.count()},
          {"lateness_last_ns", status.lateness_last.count()},
          {"lateness_max_ns", status.lateness_max.count()},
          {"elapsed_last_ns", status.elapsed_last.count()},
          {"elapsed_max_ns", status.elapsed_max.count()},
          {"next_release_ns", status.next_release.count()}};
}

Json show_component(const Running& running, ComponentBase& component) {
  const auto status = running.deployer.status(component.name());
  const auto& bundle = *component.bundle();
  Json states = Json::array();
  for (const auto* state : bundle.fsm->states()) {
    states.push_back(state->name());
  }
  Json object = {{"address", component.name()},
                 {"kind", "component"},
                 {"type", component.type().name},
                 {"core", bundle.core_type.name},
                 {"fallback_core", arch::to_json(arch::describe_fallback(component.fallback()))},
                 {"contract", bundle.core_type.contract.name},
                 {"fsm", bundle.fsm_type.name},
                 {"fsm_state", status.fsm_state},
                 {"fsm_states", std::move(states)},
                 {"machine", machine_json(*bundle.fsm)},
                 {"state", to_string(status.state)},
                 {"realtime", status.realtime},
                 {"task", task_of(bundle.task, status)},
                 {"counters", counters_of(status)}};
  if (!status.fault.empty()) {
    object["fault"] = status.fault;
  }
  if (status.state == ComponentState::recovering) {
    object["recovery"] = recovery_json(status.recovery);
  }
  add_states(object, *bundle.core);
  add_parts(object, running, {&component, nullptr});
  return object;
}

/// A core is no value but has values: its properties and observables.
Json show_core(const Element& element) {
  Json object = {{"address", element.name() + ".core"}, {"kind", "core"}};
  if (element.component != nullptr) {
    const auto& bundle = *element.component->bundle();
    object["type"] = bundle.core_type.name;
    object["contract"] = bundle.core_type.contract.name;
    add_states(object, *bundle.core);
  } else {
    object["type"] = element.resource->type().name;
    add_states(object, element.resource->core());
  }
  add_values(object, element, "core");
  return object;
}

/// Addresses of all ports that are connected to the resource.
Json users_of(const Running& running, const ResourceBase& resource) {
  Json users = Json::array();
  const auto add = [&](const Element& element) {
    for (const auto* port : element.shell().ports()) {
      const auto* binding = connection(element, *port);
      if (binding != nullptr && &binding->service().resource() == &resource) {
        users.push_back(port->address());
      }
    }
  };
  for (auto* component : running.architecture.components()) {
    add({component, nullptr});
  }
  for (auto* other : running.architecture.resources()) {
    add({nullptr, other});
  }
  return users;
}

Json show_resource(const Running& running, ResourceBase& resource) {
  Json object = {{"address", resource.name()},
                 {"kind", "resource"},
                 {"type", resource.type().name},
                 {"services", service_rows(resource)},
                 {"users", users_of(running, resource)},
                 {"lock_budget", format_duration(resource.lock().budget())},
                 {"held_max_ns", resource.lock().longest_held().count()},
                 {"over_lock_budget", resource.lock().over_budget()},
                 {"lock_timeouts", resource.lock().timeouts()},
                 {"poisoned", resource.lock().poisoned()}};
  add_parts(object, running, {nullptr, &resource});
  return object;
}

/// Some addresses have a value without being an object: attributes of a task, statistics.
Error no_object(const Running& running, const std::string& address, Error error) {
  if (sample_at(running, address)) {
    error.hint = "mauvectl get " + address + " prints its value; mauvectl show " +
                 address.substr(0, address.find('.')) + " shows the whole component";
  }
  return error;
}

Result<Json> show_target(const Running& running, const std::string& address) {
  const auto target = find_target(running, address);
  if (!target) {
    return no_object(running, address, target.error());
  }
  Json object;
  if (target->property != nullptr) {
    object = property_row(address, *target->property);
    object["kind"] = "property";
  } else if (target->observable != nullptr) {
    object = observable_row(address, *target->observable);
    object["kind"] = "observable";
  } else if (target->port != nullptr) {
    object = whole_port_row(target->element, *target->port);
  } else {
    object = service_row(*target->service);
  }
  object.erase("name");
  object["address"] = address;
  if (target->port != nullptr || target->service != nullptr) {
    add_value(object, running, address, *target, {"value", "status", "age_ns"});
  }
  const auto* data = target->service != nullptr ? target->service->signature().data
                     : target->port != nullptr  ? target->port->signature().data
                                                : nullptr;
  if (data != nullptr && data->describe != nullptr) {
    object["fields"] = arch::to_json(data->describe());
  }
  return object;
}

/// A type of data of a plugin, or one of the runtime such as double.
Json show_type(const DataType& type) {
  Json object = {
      {"address", type.name}, {"kind", "type"}, {"type", type.name}, {"bytes", type.size}};
  const auto fields = type.describe == nullptr ? Value() : type.describe();
  if (fields.get_if<Value::Array>() != nullptr) {
    object["fields"] = arch::to_json(fields);
  }
  return object;
}

/// Of a plugin, but no type of data: only its instances have values.
bool is_brought(const plugin::Catalog& catalog, const std::string& name) {
  return catalog.core(name) || catalog.fsm(name) || catalog.component(name) ||
         catalog.resource(name);
}

Error no_type(const Running& running, const std::string& name, Error error) {
  if (is_brought(running.catalog, name)) {
    error.hint = "mauvectl explain " + name + " says what this name is";
  }
  return error;
}

}  // namespace

Result<Json> show(Running& running, const Call& call) {
  const auto address = text_or(call.params, "address");
  const auto dot = address.find('.');
  if (dot != std::string::npos && address.substr(dot) == ".core") {
    const auto element = find_element(running, address.substr(0, dot));
    return element ? Result<Json>(show_core(*element)) : element.error();
  }
  if (dot != std::string::npos) {
    return show_target(running, address);
  }
  const auto element = find_element(running, address);
  if (!element) {
    const auto type = running.catalog.type(address);
    return type
               ? Result<Json>(show_type(**type))
               : (address.find('/') == std::string::npos ? element.error()
                                                         : no_type(running, address, type.error()));
  }
  return element->component != nullptr ? show_component(running, *element->component)
                                       : show_resource(running, *element->resource);
}

Result<Json> get(Running& running, const Call& call) {
  return sample_at(running, text_or(call.params, "address"));
}

}  // namespace mauve::daemon
