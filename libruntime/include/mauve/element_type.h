// SPDX-License-Identifier: LGPL-3.0-or-later
/// How the runtime makes elements it knows by name only: the entries of a plugin's registration
/// and of the catalog.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <typeinfo>

#include <mauve/class_name.h>
#include <mauve/core.h>
#include <mauve/fsm.h>
#include <mauve/interface.h>
#include <mauve/shell.h>
#include <mauve/type.h>

namespace mauve {

/// The class that a state machine calls and that a core implements. Cores of the same contract
/// replace one another; the fingerprint differs when the plugins were built with different headers.
struct Contract {
  std::string name;               ///< "guidance/core/1", or the compiler's name
  std::uint64_t fingerprint = 0;  ///< sizes of contract and shell
  std::string shell;              ///< compiler's name of the shell the core expects

  friend bool operator==(const Contract&, const Contract&) = default;
};

namespace detail {

template <typename T>
struct ContractOf {
  using type = T;
};
template <typename T>
requires requires { typename T::Contract; }
struct ContractOf<T> {
  using type = typename T::Contract;
};

template <typename CoreT>
Contract contract_of() {
  using C = typename ContractOf<CoreT>::type;
  static_assert(std::is_base_of_v<C, CoreT>, "a core derives from its contract class");
  Contract contract;
  if constexpr (requires { C::contract; }) {
    contract.name = C::contract;
  } else {
    contract.name = class_name(typeid(C));
  }
  contract.fingerprint = hash(sizeof(C), hash(sizeof(typename C::ShellType), hash(contract.name)));
  contract.shell = class_name(typeid(typename C::ShellType));
  return contract;
}

/// How instances are made: plain `new T`, wrapped by the catalog so that they keep their library.
template <typename Base>
using Make = std::function<std::shared_ptr<Base>()>;

template <typename Base, typename T>
std::shared_ptr<Base> make() {
  return std::make_shared<T>();
}

}  // namespace detail

/// A shell by name of its class.
struct ShellType {
  std::string name;
  detail::Make<Shell> make;

  template <typename T>
  static ShellType of() {
    return {class_name(typeid(T)), detail::make<Shell, T>};
  }
};

/// A core by name: "guidance/potential_field".
struct CoreType {
  std::string name;
  Contract contract;
  detail::Make<CoreBase> make;

  template <typename T>
  static CoreType of(std::string name) {
    return {std::move(name), detail::contract_of<T>(), detail::make<CoreBase, T>};
  }
};

/// A state machine by name.
struct FsmType {
  std::string name;
  Contract contract;
  detail::Make<FsmBase> make;

  template <typename T>
  static FsmType of(std::string name) {
    return {std::move(name), detail::contract_of<typename T::CoreType>(), detail::make<FsmBase, T>};
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
