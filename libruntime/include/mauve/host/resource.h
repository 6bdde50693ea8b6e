// SPDX-License-Identifier: LGPL-3.0-or-later
/// Resource = shell + core + interface, without a thread: its core runs in the caller's thread,
/// one caller at a time (paper 3.5).
#pragma once

#include <memory>
#include <string>
#include <string_view>

#include <mauve/detail/binding.h>
#include <mauve/detail/element_type.h>
#include <mauve/detail/resource_lock.h>
#include <mauve/interface.h>

namespace mauve {

class Architecture;
class ServiceBase;
class Tap;

/// The base class of resources, through which the runtime uses them. Owned by an Architecture.
class ResourceBase {
 public:
  /// Makes the elements; made() holds the error of a constructor that throws.
  ResourceBase(std::string name, ResourceType type);
  ResourceBase(const ResourceBase&) = delete;
  ResourceBase& operator=(const ResourceBase&) = delete;
  virtual ~ResourceBase();

  [[nodiscard]] const std::string& name() const { return name_; }  ///< in its architecture
  /// Names and makers of its elements.
  [[nodiscard]] const ResourceType& type() const { return type_; }
  [[nodiscard]] Shell& shell() const { return *shell_; }   ///< its ports and properties
  [[nodiscard]] CoreBase& core() const { return *core_; }  ///< its data and algorithm
  [[nodiscard]] InterfaceBase& interface() const { return *interface_; }  ///< its services
  /// Null: there is none.
  [[nodiscard]] ServiceBase* find_service(std::string_view name) const {
    return interface_->find_service(name);
  }
  [[nodiscard]] ResourceLock& lock() { return lock_; }              ///< one caller at a time
  [[nodiscard]] const ResourceLock& lock() const { return lock_; }  ///< one caller at a time

  /// Configures shell, core and interface in this order; a failure cleans up those that this call
  /// had configured.
  Status configure();
  Status cleanup();  ///< the other way round
  /// Between configure() and cleanup().
  [[nodiscard]] bool configured() const { return configured_; }
  [[nodiscard]] const Status& made() const { return made_; }  ///< the error of a constructor

  /// Elements stay alive (and their library mapped) while anything holds this.
  [[nodiscard]] std::shared_ptr<void> keep_alive() const { return interface_; }

  /// Connects a port of the resource's own shell (a resource that writes on). [control]
  Status connect(std::string_view port, ServiceBase& service, std::shared_ptr<void> keep_alive,
                 Duration max_age = Duration{0});
  Status disconnect(std::string_view port);  ///< ends it [control]
  /// The connections in force. [control]
  [[nodiscard]] const Bindings& bindings() const { return *bindings_; }

  /// Runtime only, under the lock: callers meet this core and these connections from now on; null:
  /// as before. The interface keeps its services. The model keeps the core and the connections
  /// before alive until install(). [any]
  void switch_to(const std::shared_ptr<CoreBase>& core,
                 const std::shared_ptr<const Bindings>& bindings);
  /// Runtime only: the model shows from now on the elements that callers meet. [control]
  void install(std::shared_ptr<CoreBase> core, std::shared_ptr<const Bindings> bindings);
  /// The core that callers meet.
  [[nodiscard]] const std::shared_ptr<CoreBase>& shared_core() const { return core_; }
  /// The connections that callers meet.
  [[nodiscard]] const std::shared_ptr<const Bindings>& shared_bindings() const { return bindings_; }

 private:
  Status rebind(std::shared_ptr<const Bindings> bindings);

  std::string name_;
  ResourceType type_;
  ResourceLock lock_;
  std::shared_ptr<Shell> shell_;
  std::shared_ptr<CoreBase> core_;
  std::shared_ptr<InterfaceBase> interface_;
  std::shared_ptr<const Bindings> bindings_;
  Status made_;
  bool configured_ = false;
};

/// A resource of known classes, as a member of an Architecture, for programs and tests. A plugin
/// registers its classes with Plugin::resource() instead. Its code runs on the thread of the
/// caller, one caller at a time. [control], before deployment.
/// @snippet api_examples.cpp Resource
template <typename ShellT, typename CoreT, typename InterfaceT>
class Resource final : public ResourceBase {
 public:
  Resource(Architecture& architecture, std::string name);  ///< joins the architecture

  /// For connections and properties.
  [[nodiscard]] ShellT& shell() const { return static_cast<ShellT&>(ResourceBase::shell()); }
  /// Before deployment.
  [[nodiscard]] CoreT& core() const { return static_cast<CoreT&>(ResourceBase::core()); }
  /// Its services, to which ports are connected.
  [[nodiscard]] InterfaceT& interface() const {
    return static_cast<InterfaceT&>(ResourceBase::interface());
  }
};

}  // namespace mauve
