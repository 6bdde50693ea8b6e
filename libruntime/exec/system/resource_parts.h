// SPDX-License-Identifier: LGPL-3.0-or-later
/// The parts of a resource that a change exchanges.
#pragma once

#include <memory>

#include <mauve/detail/binding.h>

namespace mauve {
class CoreBase;
}  // namespace mauve

namespace mauve::exec {

/// The new parts of a resource; null: the part stays.
struct ResourceParts {
  std::shared_ptr<CoreBase> core;
  std::shared_ptr<const Bindings> bindings;
};

/// Does a port with these connections go on at the resource that joined under the name of the one
/// that left? Then it loses nothing.
[[nodiscard]] bool goes_on_at_replacement(const Binding& before, const Binding* after);

}  // namespace mauve::exec
