// SPDX-License-Identifier: LGPL-3.0-or-later
/// The safe values of a component, written for it when it cannot do so itself.
#pragma once

#include <chrono>

#include "exec/task/write_quietly.h"
#include "rt/thread/deadline.h"

#include <mauve/host/component.h>
#include <mauve/host/resource.h>
#include <mauve/service.h>
#include <mauve/shell.h>

namespace mauve::exec {

/// Does the component have a safe value to write?
inline bool has_safe_values(const Bundle& bundle) {
  for (const PortBase* port : bundle.shell->ports()) {
    if (port->has_safe_value() && (*bundle.bindings)[port->index()] != nullptr) return true;
  }
  return false;
}

/// Writes the safe values of the connected ports. `by_owner`: see PortBase::write_safe.
inline void write_safe_values(const Bundle& bundle, bool by_owner,
                              const rt::Watched& watched = rt::kUnwatched) {
  for (const PortBase* port : bundle.shell->ports()) {
    const Binding* binding = (*bundle.bindings)[port->index()].get();
    if (binding != nullptr) write_quietly(*port, *binding, by_owner, watched);
  }
}

/// [control] The same for a component whose thread is stuck in user code, or that has none left.
/// Services that write may be code of a plugin, so their time is limited.
inline void write_safe_values_on_behalf(const Bundle& bundle) {
  const rt::Deadline deadline{std::chrono::milliseconds(200)};
  write_safe_values(bundle, false, deadline.watched());
}

/// [control] Those among them that end by themselves: resources whose lock is held for some stores
/// only, and that run no code of a plugin.
inline void write_short_safe_values_on_behalf(const Bundle& bundle) {
  for (const PortBase* port : bundle.shell->ports()) {
    const Binding* binding = (*bundle.bindings)[port->index()].get();
    const bool is_short = binding != nullptr && !binding->service().resource().lock().timed();
    if (is_short) write_quietly(*port, *binding, false);
  }
}

}  // namespace mauve::exec
