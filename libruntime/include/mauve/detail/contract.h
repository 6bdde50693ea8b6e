// SPDX-License-Identifier: LGPL-3.0-or-later
/// Contract: the description on which a core, a state machine and a shell of different plugins must
/// agree before one uses the other. Each plugin describes it as its own compiler saw it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <type_traits>
#include <typeinfo>
#include <vector>

#include <mauve/core.h>
#include <mauve/detail/class_name.h>
#include <mauve/shell.h>

namespace mauve {

/// A port, property, observable or state as it registered itself in its object.
struct Member {
  std::string name;          ///< "port out", "property gain", "state guidance/1"
  std::string type;          ///< "write double"
  std::uint64_t layout = 0;  ///< of its type
  std::size_t offset = 0;    ///< where it lies in its object, bytes

  friend bool operator==(const Member&, const Member&) = default;
};

/// The class that a state machine calls and that a core implements. Cores of the same contract
/// replace one another. Contracts of one name differ when plugins were built with different
/// headers.
struct Contract {
  std::string name;           ///< "guidance/core/1", or the compiler's name
  std::size_t size = 0;       ///< of the contract class, bytes
  std::size_t functions = 0;  ///< entries in its table of virtual functions; 0: a final class
  std::string shell;          ///< compiler's name of the shell that the core expects
  std::size_t shell_size = 0;
  std::vector<Member> shell_members;

  friend bool operator==(const Contract&, const Contract&) = default;
};

/// The ports, properties and observables within the `size` bytes of a shell, in the order of their
/// declaration. Members that the shell keeps on the heap are not part of its layout. [factory]
[[nodiscard]] std::vector<Member> members_of(const Shell& shell, std::size_t size);
/// The properties, observables and states within the first `size` bytes of a core: those of its
/// contract class. [factory]
[[nodiscard]] std::vector<Member> members_of(const CoreBase& core, std::size_t size);

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

/// A virtual function that is declared after all those of C. No object of it is ever made.
template <typename C>
struct AfterAll : C {
  virtual void mauve_after_all() {}
};

/// How many entries the table of virtual functions of C has: the next one would be that of
/// AfterAll. Both compilers represent a pointer to a virtual member by its slot in the table, one
/// plus its offset on x86-64.
template <typename C>
std::size_t count_functions() {
  if constexpr (std::is_final_v<C>) {
    return 0;
  } else {
    const auto last = &AfterAll<C>::mauve_after_all;
    std::size_t offset = 0;
    static_assert(sizeof last >= sizeof offset);
    std::memcpy(&offset, &last, sizeof offset);
    return offset / sizeof(void*);
  }
}

template <typename ShellT>
std::vector<Member> shell_members() {
  if constexpr (std::is_default_constructible_v<ShellT>) {
    return members_of(*std::make_unique<ShellT>(), sizeof(ShellT));
  } else {
    return {};
  }
}

template <typename C>
Contract contract_of() {
  using ShellT = typename C::ShellType;
  Contract contract;
  if constexpr (requires { C::contract; }) {
    contract.name = C::contract;
  } else {
    contract.name = class_name(typeid(C));
  }
  contract.size = sizeof(C);
  contract.functions = count_functions<C>();
  contract.shell = class_name(typeid(ShellT));
  contract.shell_size = sizeof(ShellT);
  contract.shell_members = shell_members<ShellT>();
  return contract;
}

}  // namespace detail
}  // namespace mauve
