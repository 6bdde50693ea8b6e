// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/thread/stack.h"

#include <pthread.h>
#include <sys/mman.h>
#include <unistd.h>

#include "rt/process/memory.h"

namespace mauve::rt {
namespace {

/// Below the frame that calls, for the calls that it makes.
constexpr std::uintptr_t kInUse = std::uintptr_t{16} * 1024;

struct Stack {
  std::byte* begin = nullptr;
  std::size_t size = 0;
  std::size_t guard = 0;
};

/// Of the calling thread; empty: not known.
Stack own_stack() {
  Stack stack;
  pthread_attr_t attributes;
  if (pthread_getattr_np(pthread_self(), &attributes) != 0) return stack;
  void* begin = nullptr;
  if (pthread_attr_getstack(&attributes, &begin, &stack.size) == 0) {
    stack.begin = static_cast<std::byte*>(begin);
    pthread_attr_getguardsize(&attributes, &stack.guard);
  }
  pthread_attr_destroy(&attributes);
  return stack;
}

std::uintptr_t page_of(const void* address) {
  const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  return reinterpret_cast<std::uintptr_t>(address) / page * page;
}

}  // namespace

void set_default_stack(std::size_t bytes) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  static_cast<void>(bytes);  // instrumented frames are larger
#else
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstacksize(&attributes, bytes);
  pthread_setattr_default_np(&attributes);
  pthread_attr_destroy(&attributes);
#endif
}

bool below_stack(std::uintptr_t address) {
  const Stack stack = own_stack();
  const auto begin = reinterpret_cast<std::uintptr_t>(stack.begin);
  return begin - stack.guard <= address && address < begin;
}

LockedAsUsed::LockedAsUsed() {
  if (!memory_is_locked()) return;
  const Stack stack = own_stack();
  const std::byte here{};
  const auto begin = reinterpret_cast<std::uintptr_t>(stack.begin);
  const std::uintptr_t end = page_of(&here) - kInUse;
  if (stack.begin == nullptr || end <= begin) return;
  // The kernel discards no page that is locked.
  if (munlock(stack.begin, stack.size) != 0) return;
  madvise(stack.begin, end - begin, MADV_DONTNEED);
  mlock2(stack.begin, stack.size, MLOCK_ONFAULT);
  begin_ = stack.begin;
  size_ = stack.size;
}

/// A later thread, a real-time one too, may get this stack from the C library.
LockedAsUsed::~LockedAsUsed() {
  if (begin_ != nullptr) mlock(begin_, size_);
}

}  // namespace mauve::rt
