// SPDX-License-Identifier: LGPL-3.0-or-later
/// Safe values are written when something ends; nothing may come of it but the write.
#pragma once

#include <mauve/port.h>

namespace mauve::exec {

/// A resource that throws when it is given a safe value cannot take the machine down with it. [any]
inline void write_quietly(const PortBase& port, const Binding& connection, bool by_owner) {
  try {
    port.write_safe(connection, by_owner);
  } catch (...) {
  }
}

}  // namespace mauve::exec
