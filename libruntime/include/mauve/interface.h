// SPDX-License-Identifier: LGPL-3.0-or-later
/// Interface: the services of a resource (paper 3.5).
#pragma once

#include <string_view>
#include <vector>

#include <mauve/configurable.h>
#include <mauve/core.h>
#include <mauve/service.h>

namespace mauve {

/// What the runtime sees of an interface.
class InterfaceBase : public Configurable {
 public:
  [[nodiscard]] const std::vector<ServiceBase*>& services() const { return services_; }
  [[nodiscard]] ServiceBase* find_service(std::string_view name) const;

  /// Runtime only. The core is exchanged under the gate of the resource.
  void bind(ResourceBase& resource, CoreBase& core) {
    resource_ = &resource;
    core_ = &core;
  }
  [[nodiscard]] ResourceBase& resource() const { return *resource_; }
  [[nodiscard]] CoreBase& core() const { return *core_; }

 private:
  friend class ServiceBase;

  std::vector<ServiceBase*> services_;
  ResourceBase* resource_ = nullptr;
  CoreBase* core_ = nullptr;
};

/// Derive from Interface<YourCore> and declare services as members.
template <typename CoreT>
class Interface : public InterfaceBase {
 public:
  using CoreType = CoreT;
};

}  // namespace mauve
