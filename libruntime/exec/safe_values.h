// SPDX-License-Identifier: LGPL-3.0-or-later
/// Safe values of a component that cannot write them itself.
#pragma once

#include "exec/write_quietly.h"

#include <mauve/component.h>
#include <mauve/shell.h>

namespace mauve::exec {

/// To all that it is connected to now.
inline void write_safe_values(const Bundle& bundle) {
  for (const PortBase* port : bundle.shell->ports()) {
    const Binding* binding = (*bundle.bindings)[port->index()].get();
    if (binding != nullptr) write_quietly(*port, binding->service());
  }
}

}  // namespace mauve::exec
