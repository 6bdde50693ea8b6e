// SPDX-License-Identifier: LGPL-3.0-or-later
/// Memory of the process: locked, and never given back to the kernel under a real-time thread.
#pragma once

#include <mauve/result.h>

namespace mauve::rt {

/// Locks all present and future memory and stops malloc from trimming. When only part of it is
/// permitted nothing is locked, and the error names the missing permission. Once per process.
Status lock_memory();

/// Has lock_memory() locked it? [any]
[[nodiscard]] bool memory_is_locked();

}  // namespace mauve::rt
