// SPDX-License-Identifier: LGPL-3.0-or-later
/// The write of a safe value to a resource whose code may throw or crash.
#pragma once

#include "rt/thread/run_guarded.h"

#include <mauve/detail/port_base.h>
#include <mauve/detail/resource_lock.h>

namespace mauve::exec {

/// Writes the safe value of the port, if any. A resource that throws or crashes while it takes the
/// value does not end the process; one that crashes is poisoned. `watched`: see rt::run_guarded().
/// [any]
inline void write_quietly(const PortBase& port, const Binding& connection, bool by_owner,
                          const rt::Watched& watched = rt::kUnwatched) {
  struct Write {
    const PortBase& port;
    const Binding& connection;
    bool by_owner;

    static void run(void* self) {
      const auto& write = *static_cast<Write*>(self);
      try {
        write.port.write_safe(write.connection, write.by_owner);
      } catch (...) {
      }
    }
  };
  Write write{port, connection, by_owner};
  const std::size_t held = ResourceLock::held();
  const rt::Fault fault = rt::run_guarded(&Write::run, &write, watched);
  if (fault.happened()) ResourceLock::poison_and_leave_all(held);
}

}  // namespace mauve::exec
