// SPDX-License-Identifier: LGPL-3.0-or-later
/// Making elements from their types, and configuring them in the order of dependency (paper 3.2.2).
#pragma once

#include <memory>
#include <span>
#include <string>
#include <type_traits>

#include "model/element/names.h"
#include "model/job/guard.h"

#include <mauve/detail/element_type.h>

namespace mauve {

/// In a trace a port is called by its component and its own name: "control.scan".
void name_ports_in_trace(const Shell& shell);

/// Runs a maker behind the door for exceptions, and gives the element its address. The names in it
/// are not checked yet: see check_names().
template <typename Base>
Status construct_element(const std::string& address, const detail::Make<Base>& make,
                         std::shared_ptr<Base>& into) {
  Status done = call_hook(address, "constructor", [&] { return into = make(), ok(); });
  if (done) into->adopt(address);
  if constexpr (std::is_same_v<Base, Shell>) {
    if (done) name_ports_in_trace(*into);
  }
  return done;
}

/// Constructs an element and refuses names in it that are illegal or used twice.
template <typename Base>
Status make_element(const std::string& address, const detail::Make<Base>& make,
                    std::shared_ptr<Base>& into) {
  Status done = construct_element(address, make, into);
  return done ? check_names(*into) : done;
}

/// Runs destructors behind the same door.
template <typename Drop>
Status drop_elements(const std::string& address, Drop&& drop) {
  return call_hook(address, "destructor", [&] { return drop(), ok(); });
}

/// May a core of this type be called by this state machine, and see this shell?
[[nodiscard]] Status check_contract(const std::string& at, const CoreType& core, const FsmType& fsm,
                                    const ShellType& shell);

/// Does the contract class of both cores declare the same members at the same places? Asked when
/// the state machine stays, whose functions may use them.
[[nodiscard]] Status check_same_members(const CoreBase& old, const CoreBase& now,
                                        const Contract& contract);

/// Lets a state machine that is not configured build its transitions, which touches no device, and
/// checks them; afterwards it is not configured, and its transitions are known.
Status check_machine(FsmBase& fsm);

/// Configures from front to back; a failure cleans up those that this call had configured.
Status configure_in_order(std::span<Configurable* const> elements);
/// Cleans up from back to front; returns the first error, but cleans all.
Status cleanup_in_reverse(std::span<Configurable* const> elements);

}  // namespace mauve
