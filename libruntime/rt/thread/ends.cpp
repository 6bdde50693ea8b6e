// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/thread/ends.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>

#include <dlfcn.h>
#include <err.h>
#include <error.h>
#include <sys/syscall.h>
#include <threads.h>
#include <unistd.h>

#include "base/mutex.h"
#include "rt/thread/crash_handler.h"
#include "rt/thread/run_guarded.h"

namespace mauve::rt {
namespace {

/// Does it end a process by default? Not those of run_guarded.cpp, nor the two that cannot be
/// handled.
bool is_end(int signal) {
  constexpr std::array<int, 17> kEnds{SIGHUP,    SIGINT,    SIGQUIT, SIGTRAP, SIGUSR1, SIGUSR2,
                                      SIGPIPE,   SIGALRM,   SIGTERM, SIGXCPU, SIGXFSZ, SIGSYS,
                                      SIGVTALRM, SIGSTKFLT, SIGPROF, SIGPOLL, SIGPWR};
  return std::find(kEnds.begin(), kEnds.end(), signal) != kEnds.end() ||
         (signal >= SIGRTMIN && signal <= SIGRTMAX);
}

std::atomic<pid_t> speaking_process{0};  // the process with crash handlers; a child of it has none
std::atomic<int> unexpected{0};

/// True in the process that had crash handlers.
bool speak_as_owner(const Fault& fault) {
  if (speaking_process.load() != getpid()) return false;
  run_crash_handler(fault);
  return true;
}

[[noreturn]] void end_now(int status) {
  for (;;) syscall(SYS_exit_group, status);
}

/// Before an exit() with this status.
void before_exit(int status) {
  if (speak_as_owner({.sent = true}) && status == 0 && unexpected.load() != 0) {
    end_now(unexpected.load());
  }
}

void at_exit(int status, void* /*unused*/) { before_exit(status); }
void at_quick_exit_of_any_status() { before_exit(0); }

void on_end(int signal) {
  forget_bodies();
  speak_as_owner({.signal = signal, .sent = true});
  std::signal(signal, SIG_DFL);
  raise(signal);
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, signal);
  pthread_sigmask(SIG_UNBLOCK, &set, nullptr);  // dies here
  end_now(128 + signal);                        // but as the first process of a container
}

struct Installed {
  Mutex mutex;
  std::size_t users MAUVE_GUARDED_BY(mutex) = 0;
  bool exit_seen MAUVE_GUARDED_BY(mutex) = false;
};

Installed& installed() {
  static Installed one;
  return one;
}

sigset_t all_ends() {
  sigset_t set;
  sigemptyset(&set);
  for (int signal = 1; signal <= SIGRTMAX; ++signal) {
    if (is_end(signal)) sigaddset(&set, signal);
  }
  return set;
}

/// Puts `handler` where `present` is; a signal that the program handles or ignores keeps its own.
void replace_handlers(void (*present)(int), void (*handler)(int)) {
  struct sigaction action {};
  action.sa_flags = SA_ONSTACK | SA_RESTART;
  action.sa_mask = all_ends();
  action.sa_handler = handler;
  for (int signal = 1; signal <= SIGRTMAX; ++signal) {
    struct sigaction now {};
    if (!is_end(signal) || sigaction(signal, nullptr, &now) != 0) continue;
    if ((now.sa_flags & SA_SIGINFO) == 0 && now.sa_handler == present) {
      sigaction(signal, &action, nullptr);
    }
  }
}

}  // namespace

EndHandlers::EndHandlers() {
  Installed& now = installed();
  const MutexLock lock(now.mutex);
  if (now.users++ > 0) return;
  if (!now.exit_seen) {
    on_exit(at_exit, nullptr);
    at_quick_exit(at_quick_exit_of_any_status);
    now.exit_seen = true;
  }
  speaking_process.store(getpid());
  replace_handlers(SIG_DFL, on_end);
}

EndHandlers::~EndHandlers() {
  Installed& now = installed();
  const MutexLock lock(now.mutex);
  if (--now.users > 0) return;
  speaking_process.store(0);
  replace_handlers(on_end, SIG_DFL);
}

sigset_t EndHandlers::keep_away_from_this_thread() {
  const sigset_t set = all_ends();
  sigset_t before;
  pthread_sigmask(SIG_BLOCK, &set, &before);
  return before;
}

void EndHandlers::set_unexpected_status(int status) { unexpected.store(status); }

}  // namespace mauve::rt

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // which have their own
namespace {

/// The function of this name in the C library.
template <typename Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

/// A child that a job forked ends as it asked for.
void end_body_of_owner(const mauve::rt::Fault& fault) {
  if (mauve::rt::speaking_process.load() == getpid()) mauve::rt::end_body(fault);
}

/// The text of a message, cut to the room there is.
std::array<char, 1024> formatted(const char* format, va_list words) {
  std::array<char, 1024> text{};
  std::vsnprintf(text.data(), text.size(), format, words);
  return text;
}

}  // namespace

// These stand before those of the C library. A job or hook that calls one of them ends, and not the
// process. Everywhere else they work as ever, after the crash handler.
extern "C" {

void abort() noexcept {
  end_body_of_owner({.call = "abort"});
  next<void()>("abort")();
  mauve::rt::end_now(128 + SIGABRT);
}

void exit(int status) noexcept {
  end_body_of_owner({.call = "exit", .status = status});
  next<void(int)>("exit")(status);
  mauve::rt::end_now(status);
}

void quick_exit(int status) noexcept {
  end_body_of_owner({.call = "quick_exit", .status = status});
  next<void(int)>("quick_exit")(status);
  mauve::rt::end_now(status);
}

void _exit(int status) {
  end_body_of_owner({.call = "_exit", .status = status});
  mauve::rt::before_exit(status);
  mauve::rt::end_now(status);
}

void _Exit(int status) noexcept { _exit(status); }

void pthread_exit(void* value) {
  end_body_of_owner({.call = "pthread_exit"});
  next<void(void*)>("pthread_exit")(value);
  for (;;) pause();
}

void thrd_exit(int result) {
  end_body_of_owner({.call = "thrd_exit", .status = result});
  next<void(int)>("thrd_exit")(result);
  for (;;) pause();
}

/// assert_perror().
void __assert_perror_fail(int error, const char* file, unsigned line,
                          const char* function) noexcept {
  end_body_of_owner({.call = "assert_perror"});
  next<void(int, const char*, unsigned, const char*)>("__assert_perror_fail")(error, file, line,
                                                                              function);
  mauve::rt::end_now(128 + SIGABRT);
}

/// assert() of C and C++.
void __assert_fail(const char* assertion, const char* file, unsigned line,
                   const char* function) noexcept {
  end_body_of_owner({.call = "assert"});
  next<void(const char*, const char*, unsigned, const char*)>("__assert_fail")(assertion, file,
                                                                               line, function);
  mauve::rt::end_now(128 + SIGABRT);
}

// The next ones call exit() within the C library, where the one above does not precede it.

void verr(int status, const char* format, va_list words) {
  end_body_of_owner({.call = "err", .status = status});
  next<void(int, const char*, va_list)>("verr")(status, format, words);
  mauve::rt::end_now(status);
}

void verrx(int status, const char* format, va_list words) {
  end_body_of_owner({.call = "errx", .status = status});
  next<void(int, const char*, va_list)>("verrx")(status, format, words);
  mauve::rt::end_now(status);
}

void err(int status, const char* format, ...) {
  va_list words;
  va_start(words, format);
  verr(status, format, words);
}

void errx(int status, const char* format, ...) {
  va_list words;
  va_start(words, format);
  verrx(status, format, words);
}

/// With the status 0 it returns.
void error(int status, int number, const char* format, ...) {
  if (status != 0) end_body_of_owner({.call = "error", .status = status});
  va_list words;
  va_start(words, format);
  const auto message = formatted(format, words);
  va_end(words);
  next<void(int, int, const char*, ...)>("error")(status, number, "%s", message.data());
}

void error_at_line(int status, int number, const char* file, unsigned line, const char* format,
                   ...) {
  if (status != 0) end_body_of_owner({.call = "error_at_line", .status = status});
  va_list words;
  va_start(words, format);
  const auto message = formatted(format, words);
  va_end(words);
  next<void(int, int, const char*, unsigned, const char*, ...)>("error_at_line")(
      status, number, file, line, "%s", message.data());
}

}  // extern "C"
#endif
