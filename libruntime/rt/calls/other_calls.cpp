// SPDX-License-Identifier: LGPL-3.0-or-later
/// The calls of the kind of process_wide.def that no row of it can write: with a list of arguments,
/// with two returns, and those of the C++ library.
#include "rt/calls/original.h"

#include <cstdarg>
#include <cstddef>
#include <exception>
#include <locale>
#include <new>

#include <alloca.h>
#include <sys/prctl.h>
#include <unistd.h>

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // which have their own
namespace {

using mauve::rt::Original;
using mauve::rt::refuse_in_body;

constexpr const char* kWithSpawn = MAUVE_WIDE "use posix_spawn()";
constexpr const char* kInItsUnit = MAUVE_WIDE "set it in the unit of mauved";
constexpr const char* kByException = MAUVE_WIDE "catch the exception where it matters";

constinit Original<int(int, unsigned long, unsigned long, unsigned long, unsigned long)>
    in_library_prctl{"prctl"};
constinit Original<std::terminate_handler(std::terminate_handler)> in_library_set_terminate{
    "_ZSt13set_terminatePFvvE"};
constinit Original<std::new_handler(std::new_handler)> in_library_set_new_handler{
    "_ZSt15set_new_handlerPFvvE"};
constinit Original<std::locale(const std::locale&)> in_library_locale_global{
    "_ZNSt6locale6globalERKS_"};

[[gnu::constructor]] void find_others() {
  static_cast<void>(in_library_prctl.find());
  static_cast<void>(in_library_set_terminate.find());
  static_cast<void>(in_library_set_new_handler.find());
  static_cast<void>(in_library_locale_global.find());
}

/// Of a thread only, and nothing that mauved relies on; or it only asks.
bool is_harmless(int option) {
  switch (option) {
    case PR_SET_NAME:
    case PR_GET_NAME:
    case PR_SET_TIMERSLACK:
    case PR_GET_TIMERSLACK:
    case PR_GET_DUMPABLE:
    case PR_GET_PDEATHSIG:
    case PR_GET_KEEPCAPS:
    case PR_GET_SECCOMP:
    case PR_GET_NO_NEW_PRIVS:
    case PR_GET_SECUREBITS:
    case PR_CAPBSET_READ:
      return true;
    default:
      return false;
  }
}

std::size_t count_of(std::va_list list) {
  std::size_t count = 0;
  while (va_arg(list, char*) != nullptr) ++count;
  return count;
}

}  // namespace

/// The words of a call like execl(), from `first` to the null pointer, on the stack: a child that
/// was forked may not use the heap.
#define MAUVE_WORDS(words, list, first)                                          \
  std::va_list list;                                                             \
  va_start(list, first);                                                         \
  const std::size_t count = 1 + count_of(list);                                  \
  va_end(list);                                                                  \
  auto** const words = static_cast<char**>(alloca((count + 1) * sizeof(char*))); \
  va_start(list, first);                                                         \
  words[0] = const_cast<char*>(first);                                           \
  for (std::size_t i = 1; i <= count; ++i) words[i] = va_arg(list, char*)

extern "C" {

/// The child has a copy of the memory, which POSIX permits: a function that is replaced cannot
/// return twice from one frame.
pid_t vfork() noexcept {
  refuse_in_body("vfork", kWithSpawn);
  return fork();
}

int execl(const char* path, const char* first, ...) noexcept {
  refuse_in_body("execl", kWithSpawn);
  MAUVE_WORDS(words, list, first);
  va_end(list);
  return execv(path, words);
}

int execlp(const char* file, const char* first, ...) noexcept {
  refuse_in_body("execlp", kWithSpawn);
  MAUVE_WORDS(words, list, first);
  va_end(list);
  return execvp(file, words);
}

int execle(const char* path, const char* first, ...) noexcept {
  refuse_in_body("execle", kWithSpawn);
  MAUVE_WORDS(words, list, first);
  auto* const* const environment = va_arg(list, char* const*);
  va_end(list);
  return execve(path, words, environment);
}

int prctl(int option, ...) noexcept {
  std::va_list list;
  va_start(list, option);
  const auto a = va_arg(list, unsigned long);
  const auto b = va_arg(list, unsigned long);
  const auto c = va_arg(list, unsigned long);
  const auto d = va_arg(list, unsigned long);
  va_end(list);
  if (!is_harmless(option)) refuse_in_body("prctl", kInItsUnit);
  return in_library_prctl.find()(option, a, b, c, d);
}

}  // extern "C"

/// Weak: a program that has the C++ library in itself, such as mauvectl, keeps those of the
/// library.
namespace std {

[[gnu::weak]] terminate_handler set_terminate(terminate_handler handler) noexcept {
  refuse_in_body("std::set_terminate", kByException);
  return in_library_set_terminate.find()(handler);
}

[[gnu::weak]] new_handler set_new_handler(new_handler handler) noexcept {
  refuse_in_body("std::set_new_handler", kByException);
  return in_library_set_new_handler.find()(handler);
}

/// Refused before the library takes its lock for the locale, under which it calls setlocale().
[[gnu::weak]] locale locale::global(const locale& other) {
  refuse_in_body("std::locale::global", MAUVE_WIDE "use imbue()");
  return in_library_locale_global.find()(other);
}

}  // namespace std
#endif
