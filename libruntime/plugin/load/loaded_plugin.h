// SPDX-License-Identifier: LGPL-3.0-or-later
/// The names that one plugin offers, checked, and wrapped so that the objects it makes keep its
/// code.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>

#include "mauve/detail/element_type.h"
#include "mauve/type.h"
#include "plugin/load/library.h"

namespace mauve::plugin {

template <typename T>
using ByName = std::map<std::string, T, std::less<>>;

/// A plugin that is mapped and checked, but whose names may not be in the catalog yet. The objects
/// that its types make keep the library mapped. Copies of the types do not: they throw
/// std::runtime_error when used after a newer version took over or the plugin was unloaded. Then
/// look the name up again.
class LoadedPlugin {
 public:
  /// Refused: a name twice, a name that is not "PLUGIN/name", a default core of another contract.
  static Result<LoadedPlugin> of(std::shared_ptr<Library> library);

  [[nodiscard]] const PluginInfo& info() const { return library_->info(); }
  [[nodiscard]] const std::shared_ptr<Library>& library() const { return library_; }

  ByName<CoreType> cores;  ///< those of resource types too
  ByName<FsmType> fsms;    ///< those of component types too
  ByName<ComponentType> components;
  ByName<ResourceType> resources;
  ByName<const DataType*> types;  ///< valid while the library is held

 private:
  explicit LoadedPlugin(std::shared_ptr<Library> library) : library_(std::move(library)) {}

  Status collect_cores();
  Status collect_fsms();
  Status collect_components();
  Status collect_resources();
  Status collect_types();
  [[nodiscard]] Status check_component(const ComponentType& component) const;
  [[nodiscard]] Status check_name(const std::string& name, const char* kind, bool used) const;

  std::shared_ptr<Library> library_;
};

}  // namespace mauve::plugin
