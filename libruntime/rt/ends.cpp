// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/ends.h"

#include <array>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <mutex>

#include <sys/syscall.h>
#include <unistd.h>

#include "rt/last_words.h"
#include "rt/rescue.h"

namespace mauve::rt {
namespace {

/// All that end a process by default, but those of rescue.cpp and the two that nobody can handle.
constexpr std::array<int, 17> kEnds{SIGHUP,    SIGINT,    SIGQUIT, SIGTRAP, SIGUSR1, SIGUSR2,
                                    SIGPIPE,   SIGALRM,   SIGTERM, SIGXCPU, SIGXFSZ, SIGSYS,
                                    SIGVTALRM, SIGSTKFLT, SIGPROF, SIGPOLL, SIGPWR};

std::atomic<pid_t> owner{0};  // the process that has something to say; a child of it has not

void speak_as_owner(const Fault& fault) {
  if (owner.load() == getpid()) speak_last_words(fault);
}

void at_exit() { speak_as_owner({.sent = true}); }

void on_end(int signal) {
  speak_as_owner({.signal = signal, .sent = true});
  std::signal(signal, SIG_DFL);
  raise(signal);
}

struct Installed {
  std::mutex mutex;
  std::size_t users = 0;
  bool exit_seen = false;
  std::array<struct sigaction, kEnds.size()> before{};
};

Installed& installed() {
  static Installed one;
  return one;
}

sigset_t all_ends() {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : kEnds) sigaddset(&set, signal);
  return set;
}

bool ends_the_process(const struct sigaction& action) {
  return (action.sa_flags & SA_SIGINFO) == 0 && action.sa_handler == SIG_DFL;
}

}  // namespace

EndHandlers::EndHandlers() {
  Installed& now = installed();
  const std::lock_guard lock(now.mutex);
  if (now.users++ > 0) return;
  if (!now.exit_seen) {
    std::atexit(at_exit);
    at_quick_exit(at_exit);
    now.exit_seen = true;
  }
  owner.store(getpid());
  struct sigaction action {};
  action.sa_flags = SA_ONSTACK | SA_RESTART;
  action.sa_mask = all_ends();
  action.sa_handler = on_end;
  for (std::size_t i = 0; i < kEnds.size(); ++i) {
    sigaction(kEnds[i], nullptr, &now.before[i]);
    if (ends_the_process(now.before[i])) sigaction(kEnds[i], &action, nullptr);
  }
}

EndHandlers::~EndHandlers() {
  Installed& now = installed();
  const std::lock_guard lock(now.mutex);
  if (--now.users > 0) return;
  owner.store(0);
  for (std::size_t i = 0; i < kEnds.size(); ++i) {
    if (ends_the_process(now.before[i])) sigaction(kEnds[i], &now.before[i], nullptr);
  }
}

void EndHandlers::keep_away_from_this_thread() {
  const sigset_t set = all_ends();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
}

}  // namespace mauve::rt

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // which have their own
extern "C" {

/// Stands before that of the C library, for plugins that leave without exit().
void _exit(int status) {
  mauve::rt::speak_as_owner({.sent = true});
  for (;;) syscall(SYS_exit_group, status);
}

void _Exit(int status) noexcept { _exit(status); }

}  // extern "C"
#endif
