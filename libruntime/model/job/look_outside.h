// SPDX-License-Identifier: LGPL-3.0-or-later
/// Looking at the value of a service outside of jobs, for a client.
#pragma once

#include <mauve/detail/data_status.h>
#include <mauve/detail/visitor.h>
#include <mauve/result.h>
#include <mauve/time.h>

namespace mauve {

class ServiceBase;

/// A service that computes its value runs code of a plugin, here on a thread that serves others: it
/// has this long.
inline constexpr Duration kLookMayTake{100'000'000};

/// Reads a value without removing it, as ServiceBase::look(). Code of the plugin that throws
/// is refused. Code that crashes, calls the end of the process or computes for longer than
/// kLookMayTake is ended and refused, and its resource is poisoned. Code that waits in the system
/// for longer is waited for. Ordinary threads with an rt::FaultStack only.
[[nodiscard]] Result<DataStatus> look_outside(ServiceBase& service, Visitor visitor,
                                              Cursor& cursor);

/// Writes to, calls or fires a service, guarded in the same way; `arguments` of a write is the
/// value. False: the service took nothing, since its resource was busy or is poisoned.
[[nodiscard]] Result<bool> use_outside(ServiceBase& service, void* result, void* const* arguments);

}  // namespace mauve
