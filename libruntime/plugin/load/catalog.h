// SPDX-License-Identifier: LGPL-3.0-or-later
/// Everything that can be made by name: "guidance/potential_field", "laser_scan/1", "double".
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mauve/detail/element_type.h"
#include "plugin/load/library.h"
#include "plugin/load/loaded_plugin.h"

namespace mauve::plugin {

/// Names and their present meaning. Owned by [control], except prepare_load() and release().
class Catalog {
 public:
  /// Plugins are looked for as NAME.so in these directories, in this order, and nowhere else.
  explicit Catalog(std::vector<std::string> directories = {});
  /// The same names of the same libraries, which stay mapped while the copy exists: for building
  /// something beside the running system. A plugin that is loaded into a copy is in no other one.
  /// [control]
  Catalog(const Catalog&) = default;
  Catalog& operator=(const Catalog&) = default;
  ~Catalog();

  /// The newest meaning of a name, or an error with the nearest name. [control]
  [[nodiscard]] Result<CoreType> core(std::string_view name) const;
  [[nodiscard]] Result<FsmType> fsm(std::string_view name) const;
  [[nodiscard]] Result<ComponentType> component(std::string_view name) const;
  [[nodiscard]] Result<ResourceType> resource(std::string_view name) const;
  /// A described type of a plugin, or bool, int8 to uint64, float, double, duration. The pointer
  /// keeps the library: hand it to SharedDataBase as `library`.
  [[nodiscard]] Result<std::shared_ptr<const DataType>> type(std::string_view name) const;

  /// Names of all cores that can stand behind this contract. [control]
  [[nodiscard]] std::vector<std::string> cores_for(const Contract& contract) const;
  /// All plugins by name; valid until the next change. [control]
  [[nodiscard]] std::vector<const LoadedPlugin*> plugins() const;
  [[nodiscard]] const LoadedPlugin* find(std::string_view plugin) const;
  [[nodiscard]] const std::vector<std::string>& directories() const { return directories_; }

  /// Finds, checks and maps a plugin; the catalog does not change. [factory], while [control] may
  /// go on using the catalog.
  [[nodiscard]] Result<LoadedPlugin> prepare_load(std::string_view plugin) const;
  /// Would commit() accept it? [control]
  [[nodiscard]] Status check_types(const LoadedPlugin& loaded) const;
  /// Refused: a data type of the present build is in use, and neither this build nor another plugin
  /// has it, so that the same architecture could not be started again. [control]
  [[nodiscard]] Status check_types_in_use(const LoadedPlugin& loaded) const;
  /// Puts the names of a prepared plugin in force and returns the library that had them before
  /// (null: none), for release() once its instances are replaced. Refused: a data type that
  /// another plugin registered with another layout. [control]
  Result<std::shared_ptr<Library>> commit(LoadedPlugin loaded);
  /// The same, and returns the whole plugin that had the names before (none: nothing had them).
  /// exchange() of that one gives its names back to it. [control]
  Result<std::optional<LoadedPlugin>> exchange(LoadedPlugin loaded);
  /// Takes the names away. Refused while anything made by the plugin exists: the message names
  /// the users. [control]
  Result<std::shared_ptr<Library>> remove(std::string_view plugin);

  /// A plugin that is part of the program. [control]
  Status add(Plugin plugin);

  /// The same in one call, for programs with one thread for all this. `load()` refuses a plugin
  /// that is loaded already; reload() leaves old instances on the old code, and returns their
  /// names.
  Status load(std::string_view plugin);
  Result<Unmapped> unload(std::string_view plugin);
  Result<Unmapped> reload(std::string_view plugin);

 private:
  template <typename T>
  [[nodiscard]] const T* find(ByName<T> LoadedPlugin::*kind, std::string_view name) const;
  template <typename T>
  Result<T> lookup(ByName<T> LoadedPlugin::*kind, std::string_view what,
                   std::string_view name) const;
  template <typename T>
  [[nodiscard]] Error unknown(ByName<T> LoadedPlugin::*kind, std::string_view what,
                              std::string_view name) const;
  [[nodiscard]] Error not_loaded(std::string_view plugin) const;

  std::vector<std::string> directories_;
  ByName<LoadedPlugin> plugins_;
};

}  // namespace mauve::plugin
