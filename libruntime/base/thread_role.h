// SPDX-License-Identifier: LGPL-3.0-or-later
/// ThreadRole: the thread of mauve that runs, as a comment names it in square brackets. Functions
/// that belong to one thread check it in debug and sanitizer builds (MAUVE_CHECK_THREADS), where a
/// call from another thread of mauve ends the process with a sentence. Threads without a role
/// (those of tests, of tools and of plugins) may call everything.
#pragma once

#include <cstdint>
#include <string_view>

namespace mauve {

/// See docs/concepts/threads.md for the work and the limits of each.
enum class ThreadRole : std::uint8_t {
  none,
  answer,
  control,
  disk,
  factory,
  health,
  io,
  judge,
  log,
  realtime,
  reaper,
  rules,
  stop,
  trace,
  watch,
};

/// "control", ...
[[nodiscard]] std::string_view to_string(ThreadRole role);

/// Gives the calling thread this role until it ends, and its name "mauve-control" in the system.
/// [any but rt]
void begin_thread(ThreadRole role);
/// Of the calling thread, with keep_c_locale(). Real-time threads have the names of their
/// components.
void take_thread_role(ThreadRole role);
/// The calling thread writes and reads numbers as the C locale does, whatever a plugin sets with
/// setlocale(), which is of the whole process.
void keep_c_locale();
[[nodiscard]] ThreadRole thread_role();

/// Ends the process when the calling thread has a role, and it is another one.
void check_thread_role(ThreadRole role, const char* function);

}  // namespace mauve

#if defined(MAUVE_CHECK_THREADS)
/// First in a function that belongs to one thread: MAUVE_ON_THREAD(control);
#define MAUVE_ON_THREAD(role) ::mauve::check_thread_role(::mauve::ThreadRole::role, __func__)
#else
#define MAUVE_ON_THREAD(role) static_cast<void>(0)
#endif
