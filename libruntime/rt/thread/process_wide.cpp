// SPDX-License-Identifier: LGPL-3.0-or-later
/// Calls of the C library that change something of the whole process, which stands before them. In
/// a job or hook such a call ends the job or hook, as exit() does: other components, clients and
/// files would be the ones to find out. A call that changes nothing, and one from any other code,
/// works as ever.
/// The functions chdir() and fchdir() lead relative paths elsewhere. The umask decides who reads
/// and writes the state of mauved. The functions setenv(), unsetenv(), putenv() and clearenv()
/// change memory that other threads read without a lock. The functions sigaction() and signal()
/// decide which signals end, stop or guard the process. After munlockall() the memory of real-time
/// threads may be paged out. After fork() each component pays for its first write to each page.
#include "rt/thread/run_guarded.h"

#include <csignal>
#include <cstdlib>
#include <cstring>

#include <dlfcn.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // which have their own
namespace {

using mauve::rt::end_body;
using mauve::rt::in_body;

/// The functions of the C library, looked up before any signal handler or job needs one.
template <typename Function>
Function* library(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}
struct Library {
  int (*chdir)(const char*) = library<int(const char*)>("chdir");
  int (*fchdir)(int) = library<int(int)>("fchdir");
  mode_t (*umask)(mode_t) = library<mode_t(mode_t)>("umask");
  int (*setenv)(const char*, const char*,
                int) = library<int(const char*, const char*, int)>("setenv");
  int (*unsetenv)(const char*) = library<int(const char*)>("unsetenv");
  int (*putenv)(char*) = library<int(char*)>("putenv");
  int (*clearenv)() = library<int()>("clearenv");
  int (*sigaction)(int, const struct sigaction*, struct sigaction*) =
      library<int(int, const struct sigaction*, struct sigaction*)>("sigaction");
  int (*munlockall)() = library<int()>("munlockall");
  pid_t (*fork)() = library<pid_t()>("fork");
};
const Library& in_library() {
  static const Library one;
  return one;
}
[[gnu::constructor]] void look_up() { static_cast<void>(in_library()); }

void refuse(const char* call) {
  if (in_body()) end_body({.call = call, .of_process = true});
}

bool leads_elsewhere(const struct stat& there) {
  struct stat here {};
  return stat(".", &here) != 0 || here.st_dev != there.st_dev || here.st_ino != there.st_ino;
}

bool is_other_value(const char* name, const char* value) {
  const char* const now = std::getenv(name);
  return now == nullptr || std::strcmp(now, value) != 0;
}

bool is_other_action(int signal, const struct sigaction& action) {
  struct sigaction now {};
  return in_library().sigaction(signal, nullptr, &now) == 0 && now.sa_handler != action.sa_handler;
}

}  // namespace

extern "C" {

int chdir(const char* path) noexcept {
  struct stat there {};
  if (in_body() && stat(path, &there) == 0 && leads_elsewhere(there)) refuse("chdir");
  return in_library().chdir(path);
}

int fchdir(int directory) noexcept {
  struct stat there {};
  if (in_body() && fstat(directory, &there) == 0 && leads_elsewhere(there)) refuse("fchdir");
  return in_library().fchdir(directory);
}

mode_t umask(mode_t mask) noexcept {
  refuse("umask");  // the present one cannot be asked without changing it
  return in_library().umask(mask);
}

int setenv(const char* name, const char* value, int overwrite) noexcept {
  const bool changes = name != nullptr && is_other_value(name, value) &&
                       (overwrite != 0 || std::getenv(name) == nullptr);
  if (changes) refuse("setenv");
  return in_library().setenv(name, value, overwrite);
}

int unsetenv(const char* name) noexcept {
  if (std::getenv(name) != nullptr) refuse("unsetenv");
  return in_library().unsetenv(name);
}

int putenv(char* text) noexcept {
  refuse("putenv");
  return in_library().putenv(text);
}

int clearenv() noexcept {
  refuse("clearenv");
  return in_library().clearenv();
}

int sigaction(int signal, const struct sigaction* action, struct sigaction* before) noexcept {
  if (action != nullptr && in_body() && is_other_action(signal, *action)) refuse("sigaction");
  return in_library().sigaction(signal, action, before);
}

/// As BSD and the C library have it: the handler stays, and calls of the system go on after it.
__sighandler_t signal(int signal, __sighandler_t handler) noexcept {
  struct sigaction action {};
  struct sigaction before {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  sigaddset(&action.sa_mask, signal);
  if (in_body() && is_other_action(signal, action)) refuse("signal");
  return in_library().sigaction(signal, &action, &before) == 0 ? before.sa_handler : SIG_ERR;
}

int munlockall() noexcept {
  refuse("munlockall");
  return in_library().munlockall();
}

pid_t fork() noexcept {
  refuse("fork");
  return in_library().fork();
}

}  // extern "C"
#endif
