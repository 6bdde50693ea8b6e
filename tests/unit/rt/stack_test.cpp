// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/thread/stack.h"

#include <gtest/gtest.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <thread>
#include <vector>

#include "rt/process/memory.h"
#include "rt/thread/run_guarded.h"
#include "rt/thread/thread.h"
#include "support/rights.h"

namespace mauve::rt {
namespace {

using test::may_lock_memory;

/// The result of `body` in a child process: memory that is locked, and sizes of stacks, are of the
/// whole process.
template <typename Body>
int in_a_child(const Body& body) {
  const pid_t child = fork();
  if (child == 0) _exit(body());
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

struct Pages {
  std::size_t all = 0;
  std::size_t resident = 0;
};

/// Of the stack of the calling thread.
Pages own_pages() {
  pthread_attr_t attributes;
  void* begin = nullptr;
  std::size_t size = 0;
  pthread_getattr_np(pthread_self(), &attributes);
  pthread_attr_getstack(&attributes, &begin, &size);
  pthread_attr_destroy(&attributes);
  const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  std::vector<unsigned char> present(size / page);
  mincore(begin, present.size() * page, present.data());
  Pages pages{present.size(), 0};
  for (const unsigned char one : present) pages.resident += one & 1U;
  return pages;
}

/// Uses this much of the stack of the calling thread.
__attribute__((noinline)) int use_stack(std::size_t bytes) {
  auto* const memory = static_cast<volatile char*>(__builtin_alloca(bytes));
  for (std::size_t i = 0; i < bytes; i += 1024) memory[i] = 1;
  return memory[0];
}

TEST(Stacks, OfThreadsThatAskForNoSizeHaveTheDefaultOne) {
  if (!kGuardsFaults) GTEST_SKIP() << "a sanitizer keeps its own size";
  EXPECT_EQ(in_a_child([] {
              set_default_stack(kOrdinaryStack);
              Pages pages;
              std::thread([&] { pages = own_pages(); }).join();
              const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
              return pages.all > 0 && pages.all * page <= kOrdinaryStack ? 0 : 1;
            }),
            0);
}

TEST(Stacks, AreLockedOnlyAsFarAsTheyWereUsed) {
  if (!kGuardsFaults) GTEST_SKIP() << "the memory of a sanitizer cannot be locked";
  if (!may_lock_memory()) GTEST_SKIP() << test::kMemoryNotLocked;
  const int answer = in_a_child([] {
    if (!lock_memory()) return 4;
    std::array<Pages, 3> seen;
    Thread ordinary;
    Thread of_hooks;
    static_cast<void>(
        ordinary.start({"ordinary", 0, {}, kOrdinaryStack}, [&] { seen[0] = own_pages(); }));
    ordinary.join();
    static_cast<void>(of_hooks.start({"hooks", 0, {}, kHookStack, true}, [&] {
      seen[1] = own_pages();
      use_stack(kHookStack / 2);
      seen[2] = own_pages();
    }));
    of_hooks.join();
    if (seen[0].resident != seen[0].all) return 1;
    if (seen[1].resident > seen[1].all / 16) return 2;
    return seen[2].resident >= seen[2].all / 2 && seen[2].resident < seen[2].all ? 0 : 3;
  });
  EXPECT_EQ(answer, 0);
}

/// The C library may give the stack of a thread that has ended to a real-time thread.
TEST(Stacks, AreLockedAsAWholeForTheNextThread) {
  if (!kGuardsFaults) GTEST_SKIP() << "the memory of a sanitizer cannot be locked";
  if (!may_lock_memory()) GTEST_SKIP() << test::kMemoryNotLocked;
  const int answer = in_a_child([] {
    if (!lock_memory()) return 4;
    Thread of_hooks;
    static_cast<void>(of_hooks.start({"hooks", 0, {}, kHookStack, true}, [] {}));
    of_hooks.join();
    Pages pages;
    Thread next;
    static_cast<void>(next.start({"next", 0, {}, kHookStack}, [&] { pages = own_pages(); }));
    next.join();
    return pages.all > 0 && pages.resident == pages.all ? 0 : 1;
  });
  EXPECT_EQ(answer, 0);
}

/// Calls itself so often that no stack of these tests has room for it.
__attribute__((noinline)) int fill_stack(int times) {
  volatile char frame[1024];
  frame[0] = static_cast<char>(times);
  return times == 0 ? 0 : fill_stack(times - 1) + frame[0];
}

TEST(Stacks, ThatAreFullEndTheBodyWithAFaultBelowThem) {
  if (!kGuardsFaults) GTEST_SKIP() << "a sanitizer reports a crash in its own way";
  const FaultHandlers handlers;
  Thread thread;
  bool below = false;
  bool elsewhere = true;
  Fault fault;
  ASSERT_TRUE(thread.start({"full", 0, {}, kOrdinaryStack, true}, [&] {
    const FaultStack stack;
    fault = run_guarded([](void*) { fill_stack(10'000); }, nullptr, kUnwatched);
    below = below_stack(fault.address);
    elsewhere = below_stack(0) || below_stack(reinterpret_cast<std::uintptr_t>(&stack));
  }));
  thread.join();

  EXPECT_EQ(fault.signal, SIGSEGV);
  EXPECT_TRUE(below);
  EXPECT_FALSE(elsewhere);
}

}  // namespace
}  // namespace mauve::rt
