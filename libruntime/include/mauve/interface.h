// SPDX-License-Identifier: LGPL-3.0-or-later
/// Interface: the services of a resource (paper 3.5).
#pragma once

#include <atomic>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include <mauve/core.h>
#include <mauve/detail/configurable.h>

namespace mauve {

class ResourceBase;
class ServiceBase;

/// The base class of interfaces, through which the runtime uses them.
class InterfaceBase : public Configurable {
 public:
  /// In the order of declaration.
  [[nodiscard]] const std::vector<ServiceBase*>& services() const { return services_; }
  [[nodiscard]] ServiceBase* find_service(std::string_view name) const;  ///< null: there is none

  /// Runtime only, once.
  void bind(ResourceBase& resource, std::shared_ptr<CoreBase> core) {
    resource_ = &resource;
    switch_to(std::move(core));
  }
  /// Runtime only, under the lock of the resource: the next callers meet this core.
  void switch_to(std::shared_ptr<CoreBase> core) {
    core_.store(core.get(), std::memory_order_release);
    kept_ = std::move(core);
  }
  [[nodiscard]] ResourceBase& resource() const { return *resource_; }  ///< that has this interface
  /// The core that serves callers now.
  [[nodiscard]] CoreBase& core() const { return *core_.load(std::memory_order_acquire); }

 private:
  friend class ServiceBase;

  std::vector<ServiceBase*> services_;
  ResourceBase* resource_ = nullptr;
  /// Atomic: an abandoned thread in a service read it under a lock that the resource has no
  /// more.
  std::atomic<CoreBase*> core_{nullptr};
  /// Shared: a connection may be the last to go, and gives its slot back to the core.
  std::shared_ptr<CoreBase> kept_;
};

/// Base of the services of a resource. Derive from Interface<YourCore> and declare services as
/// members. A service runs on the thread of its caller, under the resource lock. The runtime owns
/// the object.
/// @snippet api_examples.cpp Interface
template <typename CoreT>
class Interface : public InterfaceBase {
 public:
  using CoreType = CoreT;  ///< the class whose methods are services
};

}  // namespace mauve
