// SPDX-License-Identifier: LGPL-3.0-or-later
/// The names inside one element: each is a name, and an address leads to one thing only.
#pragma once

#include <mauve/result.h>

namespace mauve {

class Configurable;
class FsmBase;
class InterfaceBase;
class Shell;

/// Refuses a name that is_name() refuses, and a name that two properties or observables, two ports,
/// two services or two states share. The error is at the address of the element.
[[nodiscard]] Status check_names(const Configurable& element);
[[nodiscard]] Status check_names(const Shell& shell);
[[nodiscard]] Status check_names(const FsmBase& fsm);
[[nodiscard]] Status check_names(const InterfaceBase& interface);

}  // namespace mauve
