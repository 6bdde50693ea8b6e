// SPDX-License-Identifier: LGPL-3.0-or-later
/// The rights of the guardian's process, and its priority.
#pragma once

namespace mauve::guardian {

/// Locks all memory, asks for SCHED_FIFO above all threads of mauved but its probes, and for the
/// last place before the killer of a kernel without memory. Reports refusals on standard error; the
/// guardian works without these rights, but later.
void become_urgent();

/// From now on only the system calls that a session makes; all others fail with EPERM. Not in a
/// build with a sanitizer, which makes calls of its own.
void confine_calls();

}  // namespace mauve::guardian
