// SPDX-License-Identifier: LGPL-3.0-or-later
/// Preemption: was the thread preempted within a stretch of code? Then the time it took is not its
/// cost. Detected by the restartable sequences of Linux (rseq(2)): the kernel forgets a sequence
/// that the thread is not in whenever it preempts, moves or signals it. A look costs some loads and
/// stores; asking the kernel for the thread's processor time costs 0.4 us.
#pragma once

namespace mauve::rt {

/// Begins the stretch of code that preempted() judges. [rt]
void watch_for_preemption();

/// Was this thread preempted since watch_for_preemption()? Also true when that cannot be known: an
/// old kernel or libc, or user code that uses restartable sequences itself. [rt]
[[nodiscard]] bool preempted();

/// Ends the watch, before a thread leaves this library: the kernel reads none of its memory any
/// more. [rt]
void end_preemption_watch();

/// Does this machine detect it? Without, preempted() is always true. The first call of the process
/// sleeps for a moment to find that out, so it has to come before a job does. [any]
[[nodiscard]] bool preemption_is_reported();

}  // namespace mauve::rt
