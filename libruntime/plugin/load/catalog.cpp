// SPDX-License-Identifier: LGPL-3.0-or-later
#include "plugin/load/catalog.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "base/name.h"
#include "mauve/plugin.h"
#include "plugin/load/hold.h"
#include "plugin/load/plugin_file.h"

namespace mauve::plugin {

namespace {

/// The types that need no plugin: all that fit into a shared_data as they are.
const ByName<const DataType*>& built_in_types() {
  static const ByName<const DataType*> types = [] {
    ByName<const DataType*> all;
    for (const DataType* type :
         {&data_type<bool>(), &data_type<std::int8_t>(), &data_type<std::uint8_t>(),
          &data_type<std::int16_t>(), &data_type<std::uint16_t>(), &data_type<std::int32_t>(),
          &data_type<std::uint32_t>(), &data_type<std::int64_t>(), &data_type<std::uint64_t>(),
          &data_type<float>(), &data_type<double>(), &data_type<Duration>()}) {
      all.emplace(type->name, type);
    }
    return all;
  }();
  return types;
}

std::string quoted(std::string_view text) { return "\"" + std::string(text) + "\""; }

template <typename T>
void append_names(std::vector<std::string>& names, const ByName<T>& map) {
  for (const auto& [name, value] : map) names.push_back(name);
}

/// Where no name is near: "laser_simm" is near the last part of "drivers/laser_sim", and a name
/// that "guidance" does not bring has the hint which ones it brings.
std::string hint_by_part(std::string_view name, std::vector<std::string> known) {
  const auto slash = name.find('/');
  if (slash != std::string_view::npos) {
    std::erase_if(known,
                  [&](const auto& one) { return !one.starts_with(name.substr(0, slash + 1)); });
    return known_names(name, known);
  }
  std::vector<std::string> last_parts;
  for (const std::string& one : known) last_parts.push_back(one.substr(one.find('/') + 1));
  const auto near = std::ranges::find(last_parts, nearest_name(name, last_parts));
  if (near == last_parts.end()) return {};
  return "did you mean " + quoted(known[static_cast<std::size_t>(near - last_parts.begin())]) + "?";
}

}  // namespace

Catalog::Catalog(std::vector<std::string> directories) : directories_(std::move(directories)) {}
Catalog::~Catalog() = default;

// --- lookups -------------------------------------------------------------------------------

template <typename T>
const T* Catalog::find(ByName<T> LoadedPlugin::*kind, std::string_view name) const {
  for (const auto& [plugin, loaded] : plugins_) {
    const auto found = (loaded.*kind).find(name);
    if (found != (loaded.*kind).end()) return &found->second;
  }
  return nullptr;
}

template <typename T>
Error Catalog::unknown(ByName<T> LoadedPlugin::*kind, std::string_view what,
                       std::string_view name) const {
  constexpr bool kIsData = std::is_same_v<T, const DataType*>;
  std::vector<std::string> known;
  for (const auto& [plugin, loaded] : plugins_) append_names(known, loaded.*kind);
  if constexpr (kIsData) append_names(known, built_in_types());
  std::string message = "there is no " + std::string(what) + " " + quoted(name);
  std::string hint = did_you_mean(name, known, "\"");
  if (hint.empty() && !kIsData) hint = hint_by_part(name, known);
  const std::string owner(name.substr(0, name.find('/')));
  if (!kIsData && name.find('/') != std::string_view::npos && !plugins_.contains(owner)) {
    message += ": plugin " + quoted(owner) + " is not loaded";
    if (hint.empty()) hint = "load plugin " + quoted(owner);
  }
  if (kIsData)
    hint += std::string(hint.empty() ? "" : " ") + "A plugin registers its type: plugin.type<T>()";
  return refuse({Errc::unknown_name, "unknown_type"}, std::string(name), std::move(message),
                std::move(hint));
}

template <typename T>
Result<T> Catalog::lookup(ByName<T> LoadedPlugin::*kind, std::string_view what,
                          std::string_view name) const {
  if (const T* found = find(kind, name)) return *found;
  return unknown(kind, what, name);
}

Result<CoreType> Catalog::core(std::string_view name) const {
  return lookup(&LoadedPlugin::cores, "core", name);
}

Result<FsmType> Catalog::fsm(std::string_view name) const {
  return lookup(&LoadedPlugin::fsms, "state machine", name);
}

Result<ComponentType> Catalog::component(std::string_view name) const {
  return lookup(&LoadedPlugin::components, "component type", name);
}

Result<ResourceType> Catalog::resource(std::string_view name) const {
  return lookup(&LoadedPlugin::resources, "resource type", name);
}

Result<std::shared_ptr<const DataType>> Catalog::type(std::string_view name) const {
  const auto built_in = built_in_types().find(name);
  if (built_in != built_in_types().end()) {
    return std::shared_ptr<const DataType>(std::shared_ptr<void>(), built_in->second);
  }
  for (const auto& [plugin, loaded] : plugins_) {
    const auto found = loaded.types.find(name);
    if (found != loaded.types.end()) return keep(loaded.library(), *found->second);
  }
  return unknown(&LoadedPlugin::types, "data type", name);
}

std::vector<std::string> Catalog::cores_for(const Contract& contract) const {
  std::vector<std::string> names;
  for (const auto& [plugin, loaded] : plugins_) {
    for (const auto& [name, core] : loaded.cores) {
      if (core.contract == contract) names.push_back(name);
    }
  }
  return names;
}

std::vector<const LoadedPlugin*> Catalog::plugins() const {
  std::vector<const LoadedPlugin*> all;
  for (const auto& [name, loaded] : plugins_) all.push_back(&loaded);
  return all;
}

const LoadedPlugin* Catalog::find(std::string_view plugin) const {
  const auto found = plugins_.find(plugin);
  return found == plugins_.end() ? nullptr : &found->second;
}

// --- changes -------------------------------------------------------------------------------

Result<LoadedPlugin> Catalog::prepare_load(std::string_view plugin) const {
  const Result<PluginFile> file = read_plugin_file(directories_, plugin, Trust::of_this_process());
  if (!file) return file.error();
  Result<std::shared_ptr<Library>> library = Library::open(*file);
  if (!library) return library.error();
  return LoadedPlugin::of(*std::move(library));
}

Status Catalog::check_types(const LoadedPlugin& loaded) const {
  for (const auto& [name, type] : loaded.types) {
    if (built_in_types().contains(name)) {
      return refuse({Errc::duplicate, "type_name_in_use"}, name, "is a built-in data type");
    }
    for (const auto& [plugin, other] : plugins_) {
      const auto found = other.types.find(name);
      if (plugin == loaded.info().name || found == other.types.end()) continue;
      if (same_type(*found->second, *type)) continue;
      return refuse(
          {Errc::type_mismatch, "type_layout_differs"}, name,
          "has another layout in plugin " + loaded.info().name + " than in plugin " + plugin,
          "rebuild both with the same header, or raise the revision");
    }
  }
  return ok();
}

Status Catalog::check_types_in_use(const LoadedPlugin& loaded) const {
  const LoadedPlugin* const present = find(loaded.info().name);
  if (present == nullptr) return ok();
  const std::vector<std::string> users = present->library()->users();
  for (const auto& [name, type] : present->types) {
    const bool stays = std::ranges::any_of(plugins_, [&, &type_name = name](const auto& other) {
      const bool same = other.first == loaded.info().name;
      return (same ? loaded : other.second).types.contains(type_name);
    });
    if (stays || std::ranges::find(users, user_of_type(name)) == users.end()) continue;
    return refuse({Errc::conflict, "type_in_use"}, name,
                  "is in use, and the new build of plugin " + loaded.info().name +
                      " has no data type of this name",
                  "keep the type in the plugin, or remove its users from the file first");
  }
  return ok();
}

Result<std::shared_ptr<Library>> Catalog::commit(LoadedPlugin loaded) {
  const auto old = exchange(std::move(loaded));
  if (!old) return old.error();
  return *old ? (*old)->library() : nullptr;
}

Result<std::optional<LoadedPlugin>> Catalog::exchange(LoadedPlugin loaded) {
  if (Status good = check_types(loaded); !good) return good.error();
  std::optional<LoadedPlugin> old;
  const auto found = plugins_.find(loaded.info().name);
  if (found != plugins_.end()) {
    found->second.library()->retire();
    old = std::move(found->second);
    plugins_.erase(found);
  }
  loaded.library()->use_again();
  std::string name = loaded.info().name;
  plugins_.emplace(std::move(name), std::move(loaded));
  return old;
}

Error Catalog::not_loaded(std::string_view plugin) const {
  std::vector<std::string> known;
  append_names(known, plugins_);
  return refuse({Errc::unknown_name, "plugin_not_loaded"}, std::string(plugin.substr(0, 255)),
                "no such plugin is loaded", known_names(plugin, known));
}

Result<std::shared_ptr<Library>> Catalog::remove(std::string_view plugin) {
  const auto found = plugins_.find(plugin);
  if (found == plugins_.end()) return not_loaded(plugin);
  std::shared_ptr<Library> library = found->second.library();
  if (library->info().file.empty()) {
    return refuse({Errc::unsupported, "plugin_built_in"}, std::string(plugin),
                  "is part of the program");
  }
  std::string users;
  for (const std::string& user : library->users()) users += (users.empty() ? "" : ", ") + user;
  if (!users.empty()) {
    return refuse({Errc::wrong_state, "plugin_in_use"}, std::string(plugin),
                  "is in use by " + users, "swap or remove them first, or reload the plugin");
  }
  library->retire();
  plugins_.erase(found);
  return library;
}

Status Catalog::add(Plugin plugin) {
  if (find(plugin.name()) != nullptr) {
    return refuse({Errc::duplicate, "plugin_loaded_already"}, plugin.name(),
                  "a plugin of this name is there already");
  }
  Result<LoadedPlugin> loaded = LoadedPlugin::of(Library::compiled_in(std::move(plugin)));
  if (!loaded) return loaded.error();
  const auto done = commit(*std::move(loaded));
  return done ? ok() : Status(done.error());
}

Status Catalog::load(std::string_view plugin) {
  if (const LoadedPlugin* loaded = find(plugin)) {
    return refuse({Errc::duplicate, "plugin_loaded_already"}, std::string(plugin),
                  "is loaded already, version " + loaded->info().version,
                  "reload takes the file of now");
  }
  Result<LoadedPlugin> loaded = prepare_load(plugin);
  if (!loaded) return loaded.error();
  const auto done = commit(*std::move(loaded));
  return done ? ok() : Status(done.error());
}

Result<Unmapped> Catalog::unload(std::string_view plugin) {
  Result<std::shared_ptr<Library>> library = remove(plugin);
  if (!library) return library.error();
  return Library::release(*std::move(library));
}

Result<Unmapped> Catalog::reload(std::string_view plugin) {
  const LoadedPlugin* old = find(plugin);
  if (old == nullptr) return not_loaded(plugin);
  if (old->info().file.empty()) {
    return refuse({Errc::unsupported, "plugin_built_in"}, std::string(plugin),
                  "is part of the program");
  }
  Result<LoadedPlugin> loaded = prepare_load(plugin);
  if (!loaded) return loaded.error();
  Result<std::shared_ptr<Library>> retired = commit(*std::move(loaded));
  if (!retired) return retired.error();
  return Library::release(*std::move(retired));
}

}  // namespace mauve::plugin
