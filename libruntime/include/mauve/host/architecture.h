// SPDX-License-Identifier: LGPL-3.0-or-later
/// Architecture: components, resources and connections (paper 3.6, Listing 5).
///
///   struct Navigation : mauve::Architecture {
///     mauve::Component<HokuyoShell, Hokuyo, mauve::PeriodicFsm<Hokuyo>> hokuyo{*this, "hokuyo"};
///     mauve::SharedData<LaserScan> scan{*this, "scan"};
///     mauve::Status on_configure() override {
///       hokuyo.shell().scan.connect(scan.write_service());
///       hokuyo.shell().device = "/dev/hokuyo";
///       hokuyo.fsm().period = 25ms;
///       return mauve::ok();
///     }
///   };
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <mauve/element.h>
#include <mauve/host/component.h>
#include <mauve/host/resource.h>
#include <mauve/host/ring_buffer.h>
#include <mauve/host/shared_data.h>

namespace mauve {

/// A system of components and resources: derive from it and declare them as members, or let a file
/// build one. Used by one thread, [control]; it alone owns the model. It outlives its Deployer.
/// @snippet api_examples.cpp Architecture
class Architecture {
 public:
  explicit Architecture(std::string name = "architecture") : name_(std::move(name)) {}  ///< empty
  Architecture(const Architecture&) = delete;
  Architecture& operator=(const Architecture&) = delete;
  virtual ~Architecture();

  [[nodiscard]] const std::string& name() const { return name_; }  ///< as given
  /// In the order in which they were added.
  [[nodiscard]] const std::vector<ComponentBase*>& components() const { return components_; }
  /// In the order in which they were added.
  [[nodiscard]] const std::vector<ResourceBase*>& resources() const { return resources_; }
  /// Null: there is none.
  [[nodiscard]] ComponentBase* find_component(std::string_view name) const;
  [[nodiscard]] ResourceBase* find_resource(std::string_view name) const;  ///< null: there is none
  /// "scan.read" -> the service, or an error with the nearest name.
  Result<ServiceBase*> find_service(std::string_view address) const;

  /// Members register themselves; elements made from a file are owned.
  void add(ComponentBase& component) { components_.push_back(&component); }
  /// The same for a resource.
  void add(ResourceBase& resource) { resources_.push_back(&resource); }
  ComponentBase& own(std::shared_ptr<ComponentBase> component);  ///< an element made from a file
  ResourceBase& own(std::shared_ptr<ResourceBase> resource);     ///< an element made from a file
  /// Takes an element out. Returns its owner, or null for a member of a derived class.
  std::shared_ptr<ComponentBase> take_out(ComponentBase& component);
  /// The same for a resource.
  std::shared_ptr<ResourceBase> take_out(ResourceBase& resource);
  /// Runtime only: keeps the element alive as long as it is held; null: the element is a member of
  /// a derived architecture, which outlives it.
  [[nodiscard]] std::shared_ptr<void> owner_of(const ComponentBase& component) const;
  /// The same for a resource.
  [[nodiscard]] std::shared_ptr<void> owner_of(const ResourceBase& resource) const;
  /// Runtime only: the same of all elements. To be freed from the last one to the first.
  [[nodiscard]] std::vector<std::shared_ptr<void>> owners() const;

  /// Runs on_configure(), checks the wiring, then configures resources and components in their
  /// order; a failure undoes all, and its error names the element.
  Status configure();
  Status cleanup();  ///< the other way round
  /// Between configure() and cleanup().
  [[nodiscard]] bool configured() const { return configured_; }

 protected:
  /// Connections and properties of an architecture written in code.
  virtual Status on_configure() { return ok(); }

 private:
  std::string name_;
  std::vector<ComponentBase*> components_;
  std::vector<ResourceBase*> resources_;
  std::vector<std::shared_ptr<ComponentBase>> owned_components_;
  std::vector<std::shared_ptr<ResourceBase>> owned_resources_;
  bool configured_ = false;
};

// --- members of an architecture ------------------------------------------------------------

template <typename ShellT, typename CoreT, typename FsmT>
Component<ShellT, CoreT, FsmT>::Component(Architecture& architecture, std::string name)
    : ComponentBase(std::move(name),
                    {class_name(typeid(FsmT)),
                     ShellType::of<ShellT>(),
                     FsmType::of<FsmT>(class_name(typeid(FsmT))),
                     {}},
                    CoreType::of<CoreT>(class_name(typeid(CoreT)))) {
  detail::check_parts<ShellT, CoreT, FsmT>();
  architecture.add(*this);
}

template <typename ShellT, typename CoreT, typename InterfaceT>
Resource<ShellT, CoreT, InterfaceT>::Resource(Architecture& architecture, std::string name)
    : ResourceBase(std::move(name), {class_name(typeid(InterfaceT)), ShellType::of<ShellT>(),
                                     CoreType::of<CoreT>(class_name(typeid(CoreT))),
                                     detail::make<InterfaceBase, InterfaceT>}) {
  detail::check_resource<ShellT, CoreT, InterfaceT>();
  architecture.add(*this);
}

template <typename T>
SharedData<T>::SharedData(Architecture& architecture, std::string name)
    : SharedDataBase(std::move(name), data_type<T>()) {
  architecture.add(*this);
}

template <typename T>
SharedData<T>::SharedData(Architecture& architecture, std::string name, const T& initial)
    : SharedDataBase(std::move(name), data_type<T>(), &initial) {
  architecture.add(*this);
}

template <typename T>
RingBuffer<T>::RingBuffer(Architecture& architecture, std::string name)
    : RingBufferBase(std::move(name), data_type<T>()) {
  architecture.add(*this);
}

}  // namespace mauve
