// SPDX-License-Identifier: LGPL-3.0-or-later
/// The names of a Spec against the catalog: which type, core, state machine and data is meant.
#pragma once

#include <memory>
#include <optional>

#include "arch/parse/spec.h"
#include "mauve/detail/element_type.h"
#include "mauve/type.h"

namespace mauve::plugin {
class Catalog;
}  // namespace mauve::plugin

namespace mauve::arch {

/// The types of the elements of a component. An absent one was refused and is reported.
struct ComponentParts {
  std::optional<ComponentType> type;
  std::optional<CoreType> core;
  std::optional<FsmType> fsm;  ///< the one of the type, or the one that the file names

  [[nodiscard]] bool complete() const { return type && core && fsm; }
};

/// The types of a resource: a type of a plugin, or the data of a built-in one.
struct ResourceParts {
  std::optional<ResourceType> type;
  std::shared_ptr<const DataType> data;
};

/// Looks names up for one Spec. An unknown name is reported with the nearest one, and not again
/// when its whole plugin could not be loaded. [control]
class Resolver {
 public:
  Resolver(const Spec& spec, const plugin::Catalog& catalog, Problems& problems)
      : spec_(spec), catalog_(catalog), problems_(problems) {}

  [[nodiscard]] ComponentParts component(const ComponentSpec& component);
  /// The fallback core of a component that names one. Without `fsm` only the name is checked.
  [[nodiscard]] std::optional<CoreType> fallback(const ComponentSpec& component,
                                                 const std::optional<FsmType>& fsm);
  [[nodiscard]] std::optional<ResourceParts> resource(const ResourceSpec& resource);

 private:
  template <typename T>
  std::optional<T> find(const PlacedText& name, const std::string& at,
                        Result<T> (plugin::Catalog::*lookup)(std::string_view) const);
  std::optional<CoreType> core_of(const ComponentSpec& component,
                                  const std::optional<ComponentType>& type);
  bool fits(const CoreType& core, const std::optional<FsmType>& fsm, Position where,
            const std::string& at);
  std::optional<ResourceParts> built_in(const ResourceSpec& resource);
  bool plugin_loaded(const PlacedText& name, const std::string& at);
  [[nodiscard]] bool all_plugins_loaded() const;
  std::string fitting_cores(const Contract& contract) const;

  const Spec& spec_;
  const plugin::Catalog& catalog_;
  Problems& problems_;
};

}  // namespace mauve::arch
