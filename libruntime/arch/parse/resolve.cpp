// SPDX-License-Identifier: LGPL-3.0-or-later
#include "arch/parse/resolve.h"

#include <algorithm>
#include <string>
#include <utility>

#include "arch/parse/built_in.h"
#include "base/address.h"
#include "base/name.h"
#include "mauve/type.h"
#include "plugin/load/catalog.h"
#include "plugin/load/loaded_plugin.h"

namespace mauve::arch {

ComponentParts Resolver::component(const ComponentSpec& component) {
  ComponentParts parts;
  parts.type = find(component.type, component.name + ".type", &plugin::Catalog::component);
  if (component.fsm) {
    parts.fsm = find(*component.fsm, component.name + ".fsm", &plugin::Catalog::fsm);
  } else if (parts.type) {
    parts.fsm = parts.type->fsm;
  }
  parts.core = core_of(component, parts.type);
  const PlacedText& named = component.core ? *component.core : component.type;
  if (parts.core && !fits(*parts.core, parts.fsm, named.where, component.name + ".core")) {
    parts.core.reset();
  }
  return parts;
}

std::optional<CoreType> Resolver::fallback(const ComponentSpec& component,
                                           const std::optional<FsmType>& fsm) {
  const std::string at = component.name + ".fallback_core";
  const PlacedText& named = component.fallback->core;
  auto core = find(named, at, &plugin::Catalog::core);
  if (core && !fits(*core, fsm, named.where, at)) core.reset();
  return core;
}

bool Resolver::fits(const CoreType& core, const std::optional<FsmType>& fsm, Position where,
                    const std::string& at) {
  if (!fsm || core.contract.name == fsm->contract.name) return true;
  problems_.add(where, {Errc::type_mismatch, "core_other_contract"}, at,
                "core " + core.name + " fulfils contract " + core.contract.name +
                    ", but state machine " + fsm->name + " calls " + fsm->contract.name,
                fitting_cores(fsm->contract));
  return false;
}

std::optional<CoreType> Resolver::core_of(const ComponentSpec& component,
                                          const std::optional<ComponentType>& type) {
  const std::string at = component.name + ".core";
  if (component.core) return find(*component.core, at, &plugin::Catalog::core);
  if (!type) return std::nullopt;
  if (!type->default_core.empty()) {
    return find({type->default_core, component.type.where}, at, &plugin::Catalog::core);
  }
  problems_.add(component.where, {Errc::invalid_value, "file_key_missing"}, at,
                "\"core\" is missing: components of type " + type->name + " need one",
                fitting_cores(type->fsm.contract));
  return std::nullopt;
}

std::optional<ResourceParts> Resolver::resource(const ResourceSpec& resource) {
  if (is_built_in(resource.type.value)) return built_in(resource);
  const std::string at = resource.name + ".type";
  if (is_name(resource.type.value)) {
    const std::string nearest =
        nearest_name(resource.type.value, {std::string(kSharedData), std::string(kRingBuffer)});
    problems_.add(resource.type.where, {Errc::unknown_name, "unknown_type"}, at,
                  "there is no built-in resource type \"" + resource.type.value + "\"",
                  nearest.empty() ? "there is: shared_data, ring_buffer; others are \"plugin/name\""
                                  : "did you mean \"" + nearest + "\"?");
    return std::nullopt;
  }
  auto type = find(resource.type, at, &plugin::Catalog::resource);
  if (!type) return std::nullopt;
  if (resource.data) {
    problems_.add(resource.data->where, {Errc::invalid_value, "file_key_without_meaning"},
                  resource.name + ".data", "has no meaning here",
                  "only shared_data and ring_buffer take \"data\"");
  }
  return ResourceParts{std::move(type), nullptr};
}

std::optional<ResourceParts> Resolver::built_in(const ResourceSpec& resource) {
  const std::string at = resource.name + ".data";
  if (!resource.data) {
    problems_.add(resource.where, {Errc::invalid_value, "file_key_missing"}, at,
                  "\"data\" is missing: " + resource.type.value + " needs a data type",
                  "write \"data\": \"velocity/1\"");
    return std::nullopt;
  }
  Result<std::shared_ptr<const DataType>> data = catalog_.type(resource.data->value);
  if (!data && !all_plugins_loaded()) return std::nullopt;  // it may be of the one refused
  if (!data) {
    problems_.add(resource.data->where, {Errc::unknown_name, "unknown_type"}, at,
                  data.error().message, data.error().hint);
    return std::nullopt;
  }
  if (!(*data)->flat) {
    problems_.add(resource.data->where, {Errc::type_mismatch, "type_without_fixed_size"}, at,
                  "data of type " + (*data)->name + " has no fixed size and cannot be exchanged",
                  "use fixed-capacity members such as mauve::Bounded and mauve::Text");
    return std::nullopt;
  }
  return ResourceParts{std::nullopt, *std::move(data)};
}

template <typename T>
std::optional<T> Resolver::find(const PlacedText& name, const std::string& at,
                                Result<T> (plugin::Catalog::*lookup)(std::string_view) const) {
  if (name.value.empty() || !plugin_loaded(name, at)) return std::nullopt;
  Result<T> found = (catalog_.*lookup)(name.value);
  if (found) return *std::move(found);
  problems_.add(name.where, reason_of(found.error()), at, found.error().message,
                found.error().hint);
  return std::nullopt;
}

bool Resolver::plugin_loaded(const PlacedText& name, const std::string& at) {
  const std::size_t slash = name.value.find('/');
  if (slash == std::string::npos) return true;
  const std::string plugin = name.value.substr(0, slash);
  if (catalog_.find(plugin) != nullptr) return true;
  const bool listed = std::any_of(spec_.plugins.begin(), spec_.plugins.end(),
                                  [&](const PlacedText& item) { return item.value == plugin; });
  if (listed) return false;  // it was refused, which is reported once, at its own place
  std::vector<std::string> known;
  for (const plugin::LoadedPlugin* loaded : catalog_.plugins())
    known.push_back(loaded->info().name);
  for (const PlacedText& item : spec_.plugins) known.push_back(item.value);
  const std::string nearest = nearest_name(plugin, known);
  problems_.add(name.where, {Errc::unknown_name, "plugin_not_loaded"}, at,
                "plugin \"" + plugin + "\" is not loaded",
                nearest.empty() ? "add \"" + plugin + "\" to \"plugins\""
                                : "did you mean \"" + nearest + name.value.substr(slash) +
                                      "\"? Or add \"" + plugin + "\" to \"plugins\"");
  return false;
}

bool Resolver::all_plugins_loaded() const {
  return std::all_of(spec_.plugins.begin(), spec_.plugins.end(), [&](const PlacedText& plugin) {
    return catalog_.find(plugin.value) != nullptr;
  });
}

std::string Resolver::fitting_cores(const Contract& contract) const {
  std::string text;
  for (const std::string& core : catalog_.cores_for(contract)) {
    text += (text.empty() ? "cores that fit: " : ", ") + core;
  }
  return text.empty() ? "no loaded plugin has a core of contract " + contract.name : text;
}

}  // namespace mauve::arch
