// SPDX-License-Identifier: LGPL-3.0-or-later
/// How the runtime makes elements it knows by name only: the entries of a plugin's registration
/// and of the catalog.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <typeinfo>
#include <vector>

#include <mauve/core.h>
#include <mauve/detail/class_name.h>
#include <mauve/detail/contract.h>
#include <mauve/interface.h>
#include <mauve/shell.h>

namespace mauve {

class FsmBase;

namespace detail {

/// How instances are made: plain `new T`, wrapped by the catalog so that they keep their library.
template <typename Base>
using Make = std::function<std::shared_ptr<Base>()>;

template <typename Base, typename T>
std::shared_ptr<Base> make() {
  static_assert(std::is_base_of_v<Base, T>, "mauve: an element of another kind is expected here");
  static_assert(!std::is_abstract_v<T>,
                "mauve: this class is abstract, so no object of it can be made: override every "
                "pure virtual function of its contract; the next error names those that are left");
  if constexpr (std::is_abstract_v<T>) {
    return std::shared_ptr<Base>(new T);
  } else {
    static_assert(std::is_default_constructible_v<T>,
                  "mauve: an element is made without arguments: give it no constructor, and let "
                  "its members be initialised where they are declared");
    return std::make_shared<T>();
  }
}

/// The contract of a core class.
template <typename CoreT>
Contract contract_of_core() {
  static_assert(std::is_base_of_v<CoreBase, CoreT>,
                "mauve: a core derives from mauve::Core<YourShell> or from a contract class");
  using C = typename ContractOf<CoreT>::type;
  static_assert(std::is_base_of_v<C, CoreT>, "mauve: a core derives from its contract class");
  return contract_of<C>();
}

/// The shell, core and state machine of a component fit one another.
template <typename ShellT, typename FsmT>
constexpr void check_parts() {
  static_assert(std::is_base_of_v<Shell, ShellT>,
                "mauve: the first class of a component is its shell, derived from mauve::Shell");
  static_assert(std::is_base_of_v<FsmBase, FsmT>,
                "mauve: the last class of a component is its state machine, derived from "
                "mauve::Fsm<YourContract>");
  static_assert(std::is_same_v<typename FsmT::CoreType::ShellType, ShellT>,
                "mauve: this state machine calls cores of another shell: name the shell that its "
                "contract class has in mauve::Core<...>");
}
template <typename ShellT, typename CoreT, typename FsmT>
constexpr void check_parts() {
  check_parts<ShellT, FsmT>();
  static_assert(std::is_base_of_v<CoreBase, CoreT>,
                "mauve: the second class of a component is its core, derived from mauve::Core");
  static_assert(std::is_same_v<typename ContractOf<CoreT>::type,
                               typename ContractOf<typename FsmT::CoreType>::type>,
                "mauve: this core fulfils another contract than its state machine calls: derive "
                "the core from the class that is named in mauve::Fsm<...>");
}

/// The same for a resource.
template <typename ShellT, typename CoreT, typename InterfaceT>
constexpr void check_resource() {
  static_assert(std::is_base_of_v<Shell, ShellT>,
                "mauve: the first class of a resource is its shell, derived from mauve::Shell");
  static_assert(std::is_base_of_v<CoreBase, CoreT>,
                "mauve: the second class of a resource is its core, derived from mauve::Core");
  static_assert(std::is_base_of_v<InterfaceBase, InterfaceT>,
                "mauve: the third class of a resource is its interface, derived from "
                "mauve::Interface<YourCore>");
  static_assert(std::is_base_of_v<typename InterfaceT::CoreType, CoreT>,
                "mauve: this interface calls cores of another class: name the core, or a base "
                "class of it, in mauve::Interface<...>");
  static_assert(std::is_same_v<typename CoreT::ShellType, ShellT>,
                "mauve: this core expects another shell: name the shell of the resource in "
                "mauve::Core<...>");
}

}  // namespace detail

/// A shell by name of its class.
struct ShellType {
  std::string name;
  detail::Make<Shell> make;
  std::vector<Member> members;  ///< as the plugin that makes it sees them

  template <typename T>
  static ShellType of() {
    return {class_name(typeid(T)), detail::make<Shell, T>, detail::shell_members<T>()};
  }
};

/// A core by name: "guidance/potential_field".
struct CoreType {
  std::string name;
  Contract contract;
  detail::Make<CoreBase> make;

  template <typename T>
  static CoreType of(std::string name) {
    return {std::move(name), detail::contract_of_core<T>(), detail::make<CoreBase, T>};
  }
};

/// A state machine by name.
struct FsmType {
  std::string name;
  Contract contract;
  detail::Make<FsmBase> make;

  template <typename T>
  static FsmType of(std::string name) {
    return {std::move(name), detail::contract_of_core<typename T::CoreType>(),
            detail::make<FsmBase, T>};
  }
};

/// A kind of component: shell, contract, state machine and, optionally, the core it starts with.
struct ComponentType {
  std::string name;
  ShellType shell;
  FsmType fsm;
  std::string default_core;  ///< may be empty: the file must say `core`
};

/// A kind of resource: shell, core and interface.
struct ResourceType {
  std::string name;
  ShellType shell;
  CoreType core;
  detail::Make<InterfaceBase> interface;
};

/// The shell of resources and components that have neither port nor property.
struct EmptyShell final : Shell {};

}  // namespace mauve
