// SPDX-License-Identifier: LGPL-3.0-or-later
/// How the runtime makes elements it knows by name only: the entries of a plugin's registration
/// and of the catalog.
#pragma once

#include <concepts>
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
  constexpr bool kRight = std::derived_from<T, Base>;
  constexpr bool kAbstract = std::is_abstract_v<T>;
  static_assert(kRight, "mauve: an element of another kind is expected here");
  static_assert(!kAbstract,
                "mauve: this class is abstract, so no object of it can be made: override every "
                "pure virtual function of its contract; the next error names those that are left");
  if constexpr (kRight) {
    static_assert(
        HooksOf<T>::are_called(),
        "mauve: the runtime calls `mauve::Status on_configure()`, `void on_cleanup()` and, "
        "of a core, `void on_stop()` in this form only: declare them with `override`, or "
        "rename your method");
  }
  if constexpr (kRight && kAbstract) {
    return std::shared_ptr<Base>(new T);
  } else if constexpr (kRight) {
    constexpr bool kMade = std::is_default_constructible_v<T>;
    static_assert(kMade,
                  "mauve: an element is made without arguments: give it no constructor, and let "
                  "its members be initialised where they are declared");
    if constexpr (kMade) return std::make_shared<T>();
  }
  return nullptr;
}

/// Whether the class is a core, and names a shell that is one.
template <typename C>
constexpr bool check_core() {
  constexpr bool kCore = std::derived_from<C, CoreBase> && requires { typename C::ShellType; };
  static_assert(kCore,
                "mauve: a core derives publicly from mauve::Core<YourShell> or from a contract "
                "class");
  if constexpr (kCore) {
    constexpr bool kShell = std::derived_from<typename C::ShellType, Shell>;
    static_assert(kShell,
                  "mauve: the class in mauve::Core<...> is a shell, derived from mauve::Shell");
    return kShell;
  }
  return false;
}

/// The contract of a core class.
template <typename CoreT>
Contract contract_of_core() {
  if constexpr (check_core<CoreT>()) {
    using C = typename ContractOf<CoreT>::type;
    constexpr bool kRight = std::derived_from<CoreT, C>;
    static_assert(kRight, "mauve: a core derives from its contract class");
    if constexpr (kRight) return contract_of<C>();
  }
  return {};
}

/// Cores derive from an abstract class, so that class says that it is their contract.
template <typename C>
constexpr bool check_contract() {
  constexpr bool kNamed = !std::is_abstract_v<C> || requires { typename C::Contract; };
  static_assert(kNamed,
                "mauve: the class that a state machine calls is abstract, so other cores derive "
                "from it: let it say `using Contract = ITS_NAME;`");
  return kNamed;
}

/// A state machine of cores of some kind.
template <typename T>
inline constexpr bool kIsFsm = std::derived_from<T, FsmBase>&& requires {
  typename T::CoreType;
};
template <typename T>
constexpr bool check_fsm() {
  static_assert(kIsFsm<T>, "mauve: a state machine derives publicly from mauve::Fsm<YourContract>");
  if constexpr (kIsFsm<T>) return check_contract<typename T::CoreType>();
  return false;
}

/// The shell, core and state machine of a component fit one another: the first thing that does not
/// is one sentence.
template <typename ShellT, typename FsmT>
constexpr bool check_parts() {
  constexpr bool kShell = std::derived_from<ShellT, Shell>;
  static_assert(kShell,
                "mauve: the first class of a component is its shell, derived from mauve::Shell");
  static_assert(!kShell || kIsFsm<FsmT>,
                "mauve: the last class of a component is its state machine, derived from "
                "mauve::Fsm<YourContract>");
  if constexpr (kShell && kIsFsm<FsmT>) {
    if constexpr (check_core<typename FsmT::CoreType>()) {
      constexpr bool kSame = std::is_same_v<typename FsmT::CoreType::ShellType, ShellT>;
      static_assert(kSame,
                    "mauve: this state machine calls cores of another shell: name the shell that "
                    "its contract class has in mauve::Core<...>");
      return kSame && check_contract<typename FsmT::CoreType>();
    }
  }
  return false;
}
template <typename ShellT, typename CoreT, typename FsmT>
constexpr bool check_parts() {
  if constexpr (check_parts<ShellT, FsmT>()) {
    constexpr bool kCore = std::derived_from<CoreT, CoreBase>;
    static_assert(kCore,
                  "mauve: the second class of a component is its core, derived from mauve::Core");
    if constexpr (kCore) {
      constexpr bool kSame = std::is_same_v<typename ContractOf<CoreT>::type,
                                            typename ContractOf<typename FsmT::CoreType>::type>;
      static_assert(
          kSame,
          "mauve: this core fulfils another contract than its state machine calls: derive "
          "the core from the class that is named in mauve::Fsm<...>, and let that class "
          "say `using Contract = ITS_NAME;`");
      return kSame;
    }
  }
  return false;
}

/// The same for a resource.
template <typename ShellT, typename CoreT, typename InterfaceT>
constexpr bool check_resource() {
  constexpr bool kShell = std::derived_from<ShellT, Shell>;
  constexpr bool kCore = std::derived_from<CoreT, CoreBase>;
  constexpr bool kInterface = std::derived_from<InterfaceT, InterfaceBase>;
  static_assert(kShell,
                "mauve: the first class of a resource is its shell, derived from mauve::Shell");
  static_assert(!kShell || kCore,
                "mauve: the second class of a resource is its core, derived from mauve::Core");
  static_assert(!kShell || !kCore || kInterface,
                "mauve: the third class of a resource is its interface, derived from "
                "mauve::Interface<YourCore>");
  if constexpr (kShell && kCore && kInterface) {
    constexpr bool kCalls = std::is_base_of_v<typename InterfaceT::CoreType, CoreT>;
    constexpr bool kSees = std::is_same_v<typename CoreT::ShellType, ShellT>;
    static_assert(kCalls,
                  "mauve: this interface calls cores of another class: name the core, or a base "
                  "class of it, in mauve::Interface<...>");
    static_assert(!kCalls || kSees,
                  "mauve: this core expects another shell: name the shell of the resource in "
                  "mauve::Core<...>");
    return kCalls && kSees;
  }
  return false;
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
  std::string default_core;  ///< may be empty: the file must name `core`
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
