// SPDX-License-Identifier: LGPL-3.0-or-later
/// component.list, resource.list, service.list, core.list, fsm.list, type.list, port.list,
/// plugin.list, client.list, command.list, rpc.discover
#include <algorithm>

#include "commands/answer.h"
#include "commands/model.h"
#include "log/event.h"
#include "mauve/detail/port_base.h"
#include "mauve/host/architecture.h"
#include "mauve/service.h"
#include "plugin/load/plugin_file.h"
#include "protocol/openrpc.h"

namespace mauve::daemon {

namespace {

Json items(Json rows) { return {{"items", std::move(rows)}}; }

void add_ports(Json& rows, const Element& element) {
  for (const auto* port : element.shell().ports()) {
    const auto* binding = connection(element, *port);
    rows.push_back({{"name", element.name() + ".ports." + std::string(port->name())},
                    {"kind", to_string(port->signature().kind)},
                    {"type", port->signature().types},
                    {"service", binding == nullptr ? Json() : Json(binding->service().address())}});
  }
}

Json plugin_row(const plugin::LoadedPlugin& loaded) {
  const auto names = [](const auto& map) {
    Json out = Json::array();
    for (const auto& [name, entry] : map) {
      out.push_back(name);
    }
    return out;
  };
  const auto& info = loaded.info();
  return {{"name", info.name},
          {"version", info.version},
          {"file", info.file},
          {"build_id", info.build_id},
          {"warnings", info.warnings},
          {"cores", names(loaded.cores)},
          {"fsms", names(loaded.fsms)},
          {"components", names(loaded.components)},
          {"types", names(loaded.types)},
          {"resources", names(loaded.resources)},
          {"users", loaded.library()->users()}};
}

/// Full names of the cores that fulfil the contract, which may be swapped in.
Json cores_for(const plugin::LoadedPlugin& loaded, const Contract& contract) {
  Json names = Json::array();
  for (const auto& [name, core] : loaded.cores) {
    if (core.contract == contract) {
      names.push_back(name);
    }
  }
  return names;
}

/// Null for a contract that is a class inside the plugin: no other plugin can fulfil it.
Json public_name(const Contract& contract) {
  return contract.name.find('/') == std::string::npos ? Json() : Json(contract.name);
}

/// The contract of the component named by `for`, or nothing when it is not given.
Result<std::optional<Contract>> wanted_contract(const Running& running, const Call& call) {
  const auto name = text_or(call.params, "for");
  if (name.empty()) {
    return std::optional<Contract>();
  }
  const auto component = find_component(running, name);
  if (!component) {
    return component.error();
  }
  return std::optional<Contract>((*component)->bundle()->core_type.contract);
}

}  // namespace

Result<Json> list_components(Running& running, const Call& /*call*/) {
  Json rows = Json::array();
  for (const auto* component : running.architecture.components()) {
    const auto status = running.deployer.status(component->name());
    rows.push_back({{"name", component->name()},
                    {"type", component->type().name},
                    {"core", component->bundle()->core_type.name},
                    {"state", to_string(status.state)}});
  }
  return items(std::move(rows));
}

Result<Json> list_resources(Running& running, const Call& /*call*/) {
  Json rows = Json::array();
  for (const auto* resource : running.architecture.resources()) {
    Json services = Json::array();
    for (const auto* service : resource->interface().services()) {
      services.push_back(service->name());
    }
    rows.push_back({{"name", resource->name()},
                    {"type", resource->type().name},
                    {"services", std::move(services)}});
  }
  return items(std::move(rows));
}

Result<Json> list_services(Running& running, const Call& /*call*/) {
  Json rows = Json::array();
  for (const auto* resource : running.architecture.resources()) {
    for (const auto* service : resource->interface().services()) {
      rows.push_back({{"name", service->address()},
                      {"kind", to_string(service->signature().kind)},
                      {"type", service->signature().types}});
    }
  }
  return items(std::move(rows));
}

Result<Json> list_fsms(Running& running, const Call& /*call*/) {
  Json rows = Json::array();
  for (const auto* loaded : running.catalog.plugins()) {
    for (const auto& [name, fsm] : loaded->fsms) {
      rows.push_back({{"name", name},
                      {"plugin", loaded->info().name},
                      {"contract", public_name(fsm.contract)}});
    }
  }
  return items(std::move(rows));
}

/// Kinds of components and resources, and types of data: values of "type" and "data" in a file.
Result<Json> list_types(Running& running, const Call& /*call*/) {
  Json rows = Json::array();
  const auto add = [&](const auto& names, const std::string& plugin, const char* of) {
    for (const auto& [name, type] : names) {
      rows.push_back({{"name", name}, {"of", of}, {"plugin", plugin}});
    }
  };
  for (const auto* loaded : running.catalog.plugins()) {
    const auto& plugin = loaded->info().name;
    add(loaded->components, plugin, "component");
    add(loaded->resources, plugin, "resource");
    add(loaded->types, plugin, "data");
  }
  return items(std::move(rows));
}

Result<Json> list_cores(Running& running, const Call& call) {
  const auto contract = wanted_contract(running, call);
  if (!contract) {
    return contract.error();
  }
  Json rows = Json::array();
  for (const auto* loaded : running.catalog.plugins()) {
    for (const auto& [name, core] : loaded->cores) {
      if (!*contract || **contract == core.contract) {
        rows.push_back({{"name", name},
                        {"plugin", loaded->info().name},
                        {"contract", public_name(core.contract)}});
      }
    }
  }
  return items(std::move(rows));
}

/// [answer] Adds the builds of the files of now where these are others, or cannot be loaded.
void add_builds_on_disk(const std::vector<std::string>& directories, Json& rows) {
  for (auto& row : rows) {
    if (text_or(row, "build_id").empty()) {
      continue;  // it is part of the program, or its build is not known
    }
    const auto on_disk = plugin::build_on_disk(directories, row["name"].get<std::string>(),
                                               plugin::Trust::of_this_process());
    if (!on_disk || *on_disk != row["build_id"]) {
      row["build_on_disk"] = on_disk ? Json(*on_disk) : Json();
    }
  }
}

/// The files are read on [answer], since [control] waits for no disk.
void list_plugins(Running& running, const CallPtr& call, Ticket /*none*/) {
  const auto contract = wanted_contract(running, *call);
  if (!contract) {
    return answer(running, *call, contract.error());
  }
  if (auto room = check_long_answers(running, *call); !room) {
    return answer(running, *call, room.error());
  }
  Json rows = Json::array();
  for (const auto* loaded : running.catalog.plugins()) {
    if (!*contract) {
      rows.push_back(plugin_row(*loaded));
    } else if (auto cores = cores_for(*loaded, **contract); !cores.empty()) {
      const auto& info = loaded->info();
      rows.push_back({{"name", info.name}, {"version", info.version}, {"cores", std::move(cores)}});
    }
  }
  const auto write = [&running, call, rows = std::move(rows),
                      directories = running.catalog.directories()]() mutable {
    add_builds_on_disk(directories, rows);
    answer(running, *call, items(std::move(rows)));
  };
  running.control.write_out(write, asker_of(*call));
}

Result<Json> list_ports(Running& running, const Call& call) {
  Json rows = Json::array();
  if (const auto name = text_or(call.params, "component"); !name.empty()) {
    const auto element = find_element(running, name);
    if (!element) {
      return element.error();
    }
    add_ports(rows, *element);
    return items(std::move(rows));
  }
  for (auto* component : running.architecture.components()) {
    add_ports(rows, {component, nullptr});
  }
  for (auto* resource : running.architecture.resources()) {
    add_ports(rows, {nullptr, resource});
  }
  return items(std::move(rows));
}

Result<Json> list_clients(Running& running, const Call& call) {
  Json rows = Json::array();
  for (const auto& client : running.clients()) {
    rows.push_back({{"name", std::to_string(client.client)},
                    {"uid", client.peer.uid},
                    {"pid", client.peer.pid},
                    {"role", to_string(client.role)},
                    {"since", logging::utc(client.since)},
                    {"only_stops", client.only_urgent},
                    {"you", client.client == call.caller.client}});
  }
  return items(std::move(rows));
}

Result<Json> list_commands(Running& /*running*/, const Call& /*call*/) {
  Json rows = Json::array();
  for (const auto& method : protocol::methods()) {
    Json params = Json::array();
    for (const auto& param : method.params) {
      params.push_back({{"name", param.name}, {"required", !param.optional}});
    }
    rows.push_back({{"name", method.name},
                    {"text", method.help},
                    {"params", std::move(params)},
                    {"mutation", method.mutation()},
                    {"out_of_band", method.out_of_band()},
                    {"effect", to_string(method.effect)},
                    {"role", to_string(method.role)}});
  }
  return items(std::move(rows));
}

Result<Json> discover(Running& /*running*/, const Call& /*call*/) {
  return protocol::openrpc_document(protocol::methods());
}

}  // namespace mauve::daemon
