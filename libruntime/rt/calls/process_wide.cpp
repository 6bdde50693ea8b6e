// SPDX-License-Identifier: LGPL-3.0-or-later
/// Calls of the C library that change something of the whole process, or of a thread of mauved. In
/// a job or hook such a call ends the job or hook, as exit() does: other components, clients and
/// files would be the ones to find out. A call that changes nothing, and one from any other code,
/// works as ever. process_wide.def is the table.
#include "rt/calls/original.h"
#include "rt/thread/run_guarded.h"
#include "rt/thread/user_threads.h"

#include <clocale>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include <fcntl.h>
#include <grp.h>
#include <malloc.h>
#include <pthread.h>
#include <pty.h>
#include <sched.h>
#include <spawn.h>
#include <sys/fsuid.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/signalfd.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <unistd.h>
#include <utmp.h>

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // which have their own
namespace {

#define MAUVE_CALL(result, name, parameters, arguments, changes, because) \
  constinit mauve::rt::Original<result parameters> in_library_##name{#name};
#include "rt/calls/process_wide.def"
#undef MAUVE_CALL

/// Before any signal handler or job needs one.
[[gnu::constructor]] void find_all() {
#define MAUVE_CALL(result, name, parameters, arguments, changes, because) \
  static_cast<void>(in_library_##name.find());
#include "rt/calls/process_wide.def"
#undef MAUVE_CALL
}

bool leads_elsewhere(const struct stat& there) {
  struct stat here {};
  return stat(".", &here) != 0 || here.st_dev != there.st_dev || here.st_ino != there.st_ino;
}
bool leads_elsewhere(const char* path) {
  struct stat there {};
  return stat(path, &there) == 0 && leads_elsewhere(there);
}
bool leads_elsewhere(int folder) {
  struct stat there {};
  return fstat(folder, &there) == 0 && leads_elsewhere(there);
}

bool is_standard(int descriptor) { return descriptor >= 0 && descriptor <= STDERR_FILENO; }
bool is_standard(const FILE* file) { return file == stdin || file == stdout || file == stderr; }

bool is_other_value(const char* name, const char* value, int overwrite) {
  const char* const now = name == nullptr ? value : std::getenv(name);
  return now == nullptr || (overwrite != 0 && std::strcmp(now, value) != 0);
}

bool is_other_locale(int category, const char* name) {
  const char* const now = in_library_setlocale.find()(category, nullptr);
  return name != nullptr && (now == nullptr || std::strcmp(now, name) != 0);
}

bool is_other_action(int signal, __sighandler_t handler) {
  struct sigaction now {};
  return in_library_sigaction.find()(signal, nullptr, &now) == 0 && now.sa_handler != handler;
}

/// A thread that waits for these takes the order to end from mauved.
bool has_end_of_mauved(const sigset_t* set) {
  return set != nullptr && (sigismember(set, SIGTERM) == 1 || sigismember(set, SIGINT) == 1 ||
                            sigismember(set, SIGHUP) == 1);
}

bool is_realtime() { return sched_getscheduler(0) > SCHED_OTHER; }

/// Does the program begin as urgent as its caller?
bool keeps_priority(const posix_spawnattr_t* attributes) {
  short flags = 0;
  if (attributes != nullptr) posix_spawnattr_getflags(attributes, &flags);
  return (flags & POSIX_SPAWN_SETSCHEDULER) == 0 && is_realtime();
}

}  // namespace

extern "C" {
#define MAUVE_CALL(result, name, parameters, arguments, changes, because)             \
  result name parameters {                                                            \
    if (mauve::rt::in_body() && (changes)) mauve::rt::refuse_in_body(#name, because); \
    return in_library_##name.find() arguments;                                        \
  }
#include "rt/calls/process_wide.def"
#undef MAUVE_CALL
}  // extern "C"
#endif
