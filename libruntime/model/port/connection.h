// SPDX-License-Identifier: LGPL-3.0-or-later
/// The rules of connecting: same kind, same type, and not twice.
#pragma once

#include <memory>
#include <string_view>
#include <vector>

#include <mauve/detail/binding.h>
#include <mauve/result.h>
#include <mauve/time.h>

namespace mauve {

class PortBase;
class ServiceBase;
class Shell;

/// May `port`, now connected to `present` (may be null), be connected to `service`? A limit on the
/// age is for read ports.
[[nodiscard]] Status check_connection(const PortBase& port, const Binding* present,
                                      const ServiceBase& service, Duration max_age = Duration{0});

/// The port of this name. Refused, with the nearest name: there is none.
[[nodiscard]] Result<PortBase*> find_port(const Shell& shell, std::string_view name);

/// A copy of `table` in which port `name` of `shell` is connected to `service`.
[[nodiscard]] Result<std::shared_ptr<const Bindings>> with_connection(
    const Shell& shell, const Bindings& table, std::string_view name, ServiceBase& service,
    std::shared_ptr<void> keep_alive, Duration max_age);

/// A copy of `table` in which port `name` of `shell` is not connected.
[[nodiscard]] Result<std::shared_ptr<const Bindings>> without_connection(const Shell& shell,
                                                                         const Bindings& table,
                                                                         std::string_view name);

/// A copy of `table` with the connections that were made in code, which are moved out of the shell.
[[nodiscard]] std::shared_ptr<const Bindings> with_initial(Shell& shell, const Bindings& table);

}  // namespace mauve
