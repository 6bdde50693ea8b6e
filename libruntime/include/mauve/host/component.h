// SPDX-License-Identifier: LGPL-3.0-or-later
/// Component = shell + core + fsm, run by one real-time thread (paper 3.4).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <mauve/detail/binding.h>
#include <mauve/detail/element_type.h>
#include <mauve/host/task_attributes.h>
#include <mauve/host/value.h>
#include <mauve/result.h>
#include <mauve/time.h>

namespace mauve {

class Architecture;
class FsmBase;
namespace rt {
class Measured;
}

/// Everything a component runs with. Immutable once published; a change makes another one.
struct Bundle {
  std::shared_ptr<Shell> shell;              ///< its ports and properties
  std::shared_ptr<CoreBase> core;            ///< its algorithm
  std::shared_ptr<FsmBase> fsm;              ///< its state machine
  std::shared_ptr<const Bindings> bindings;  ///< its connections
  TaskAttributes task;                       ///< how its thread is scheduled
  CoreType core_type;                        ///< how the core was made; keeps its library loaded
  FsmType fsm_type;                          ///< how the state machine was made
  /// Measurements of its jobs; bundles with the same code share them.
  std::shared_ptr<rt::Measured> measured;
};

/// The base class of components, through which the runtime uses them. Owned by an Architecture;
/// touched by [control] only.
class ComponentBase {
 public:
  /// Makes the elements; made() holds the error of a constructor that throws.
  ComponentBase(std::string name, ComponentType type, CoreType core);
  ComponentBase(const ComponentBase&) = delete;
  ComponentBase& operator=(const ComponentBase&) = delete;
  virtual ~ComponentBase();

  [[nodiscard]] const std::string& name() const { return name_; }  ///< in its architecture
  /// Names and makers of its elements.
  [[nodiscard]] const ComponentType& type() const { return type_; }

  /// The elements in force. [control]
  [[nodiscard]] const std::shared_ptr<const Bundle>& bundle() const { return bundle_; }
  [[nodiscard]] Shell& shell() const { return *bundle_->shell; }   ///< of the bundle in force
  [[nodiscard]] CoreBase& core() const { return *bundle_->core; }  ///< of the bundle in force
  [[nodiscard]] FsmBase& fsm() const { return *bundle_->fsm; }     ///< of the bundle in force

  /// Task attributes, before deployment.
  TaskAttributes& task();
  /// Of the bundle in force.
  [[nodiscard]] const TaskAttributes& task() const { return bundle_->task; }

  /// Configures shell, core and fsm in this order; a failure cleans up those that this call had
  /// configured.
  Status configure();
  /// The other way round.
  Status cleanup();
  /// Between configure() and cleanup().
  [[nodiscard]] bool configured() const { return configured_; }

  /// Paper's Listing 6 on a component that is not deployed or is stopped: the fsm is cleaned with
  /// the core, the shell is not touched.
  Status cleanup_core();
  /// Puts another core in place of a cleaned one; refused when the contract differs.
  Status replace_core(const CoreType& core);
  /// The same with a core of a known class.
  template <typename T>
  Status replace_core() {
    return replace_core(CoreType::of<T>(class_name(typeid(T))));
  }

  /// The core that takes over when the core fails (`fallback_core` in the file), and the properties
  /// that it is given; none: empty name. [control]
  struct Fallback {
    CoreType core;                                          ///< the core that takes over
    std::vector<std::pair<std::string, Value>> properties;  ///< names and values
  };
  /// None: the component has no fallback core.
  [[nodiscard]] const std::optional<Fallback>& fallback() const { return fallback_; }
  /// Declares the fallback core, before deployment. [control]
  void fall_back_to(std::optional<Fallback> fallback) { fallback_ = std::move(fallback); }

  /// Runtime only: the error of a constructor that failed; success: all elements were made.
  [[nodiscard]] const Status& made() const { return made_; }
  /// Runtime only: the same type from a newer build of its plugin.
  void renew(ComponentType type) { type_ = std::move(type); }
  /// Runtime only: the bundle that a committed change left in force.
  void install(std::shared_ptr<const Bundle> bundle) { bundle_ = std::move(bundle); }
  /// Runtime only: keeps the elements for ever and does not touch them, since their thread hangs in
  /// them.
  void abandon();
  /// Runtime only: before deployment the connection table is edited in place.
  Status connect(std::string_view port, ServiceBase& service, std::shared_ptr<void> keep_alive,
                 Duration max_age = Duration{0});
  /// Runtime only: the same for a connection that ends.
  Status disconnect(std::string_view port);

 private:
  Status rebind(std::shared_ptr<const Bindings> bindings);

  std::string name_;
  ComponentType type_;
  std::shared_ptr<const Bundle> bundle_;
  std::optional<Fallback> fallback_;
  Status made_;
  bool configured_ = false;
};

/// A component of known classes, as a member of an Architecture, for programs and tests. A plugin
/// registers its classes with Plugin::component() instead. A wrong combination of shell, core and
/// state machine does not compile. [control], before deployment.
/// @snippet api_examples.cpp Component
template <typename ShellT, typename CoreT, typename FsmT>
class Component final : public ComponentBase {
 public:
  Component(Architecture& architecture, std::string name);  ///< joins the architecture

  /// For connections and properties.
  [[nodiscard]] ShellT& shell() const { return static_cast<ShellT&>(ComponentBase::shell()); }
  /// The contract class: the concrete core may have been replaced.
  [[nodiscard]] auto& core() const {
    return static_cast<typename detail::ContractOf<CoreT>::type&>(ComponentBase::core());
  }
  /// For the durations of its waits.
  [[nodiscard]] FsmT& fsm() const { return static_cast<FsmT&>(ComponentBase::fsm()); }
};

}  // namespace mauve
