// SPDX-License-Identifier: LGPL-3.0-or-later
/// JobCost: which heap calls, system calls and page faults code causes, for tests of real-time
/// code. Only a test program includes this: it replaces malloc() and its kind for the whole program
/// by functions that count, and otherwise call those of the C library.
///
/// System calls are counted by "syscall user dispatch" of Linux 5.11 (prctl(2)), which needs no
/// rights. The kernel delivers SIGSYS to the thread, whose handler counts the call and makes it.
#pragma once

#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <ucontext.h>
#include <unistd.h>

#include <csignal>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <utility>

#include <mauve/detail/job.h>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define MAUVE_COUNTS_HEAP 0  // sanitizers bring their own malloc
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define MAUVE_COUNTS_HEAP 0
#endif
#endif
#ifndef MAUVE_COUNTS_HEAP
#define MAUVE_COUNTS_HEAP 1
#endif

namespace mauve {

/// Of one thread. A count is empty where it cannot be measured: heap calls under a sanitizer or
/// where the program has another malloc(), system calls beyond x86-64 and on older kernels.
struct JobCost {
  std::optional<std::uint64_t> heap_calls;    ///< malloc, calloc, realloc, aligned_alloc, free
  std::optional<std::uint64_t> system_calls;  ///< reading the clock is none
  std::uint64_t page_faults = 0;              ///< of this thread, minor and major
};

namespace detail {

struct CostCounts {
  bool on = false;
  bool only_in_jobs = false;
  std::uint64_t heap = 0;
  std::uint64_t calls = 0;
  volatile char dispatch = 0;  ///< the kernel reads it: 1 while system calls are counted
  bool armed = false;
};
inline CostCounts& cost_counts() {
  static thread_local CostCounts counts;
  return counts;
}
[[nodiscard]] inline bool counts_now(const CostCounts& counts) {
  return counts.on && (!counts.only_in_jobs || this_job().running);
}
inline void count_heap_call() {
  CostCounts& counts = cost_counts();
  if (counts_now(counts)) ++counts.heap;
}

#if defined(__x86_64__)
extern "C" {
extern char mauve_kit_begin[] __attribute__((visibility("hidden")));
extern char mauve_kit_end[] __attribute__((visibility("hidden")));
long mauve_kit_call(long number, const long long* arguments) __attribute__((visibility("hidden")));
void mauve_kit_restore() __attribute__((visibility("hidden")));
}
// The two system calls that are never dispatched: the one that the handler makes, and the one that
// ends the handler. In a group of its own, so that a program has it once. The kernel looks at the
// address after the instruction, which must lie inside too.
asm(R"(
.pushsection .text.mauve_kit,"axG",@progbits,mauve_kit,comdat
.weak mauve_kit_begin, mauve_kit_end, mauve_kit_call, mauve_kit_restore
.hidden mauve_kit_begin, mauve_kit_end, mauve_kit_call, mauve_kit_restore
mauve_kit_begin:
mauve_kit_call:
  mov %rdi, %rax
  mov %rsi, %r11
  mov 0(%r11), %rdi
  mov 8(%r11), %rsi
  mov 16(%r11), %rdx
  mov 24(%r11), %r10
  mov 32(%r11), %r8
  mov 40(%r11), %r9
  syscall
  ret
mauve_kit_restore:
  mov $15, %eax
  syscall
  ud2
mauve_kit_end:
.popsection
)");

inline void on_system_call(int /*signal*/, siginfo_t* info, void* context) {
  CostCounts& counts = cost_counts();
  if (counts_now(counts)) ++counts.calls;
  auto& registers = static_cast<ucontext_t*>(context)->uc_mcontext.gregs;
  const long long arguments[6] = {registers[REG_RDI], registers[REG_RSI], registers[REG_RDX],
                                  registers[REG_R10], registers[REG_R8],  registers[REG_R9]};
  registers[REG_RAX] = mauve_kit_call(info->si_syscall, arguments);
}

/// False: this kernel does not dispatch system calls.
inline bool arm_dispatch(CostCounts& counts) {
  if (counts.armed) return true;
  struct KernelAction {
    void (*handler)(int, siginfo_t*, void*);
    unsigned long flags;
    void (*restorer)();
    unsigned long mask;
  };
  constexpr unsigned long kRestorer = 0x04000000;
  const KernelAction action{&on_system_call, SA_SIGINFO | SA_NODEFER | kRestorer,
                            &mauve_kit_restore, 0};
  if (syscall(SYS_rt_sigaction, SIGSYS, &action, nullptr, sizeof action.mask) != 0) return false;
  constexpr int kSetSyscallUserDispatch = 59;
  const auto length = static_cast<unsigned long>(mauve_kit_end - mauve_kit_begin);
  counts.armed =
      prctl(kSetSyscallUserDispatch, 1UL, mauve_kit_begin, length, &counts.dispatch) == 0;
  return counts.armed;
}
#else
inline bool arm_dispatch(CostCounts& /*counts*/) { return false; }
#endif

/// Does the malloc() of this program count?
inline bool heap_is_counted() {
  CostCounts& counts = cost_counts();
  const std::uint64_t before = counts.heap;
  const bool in_jobs = std::exchange(counts.only_in_jobs, false);
  counts.on = true;
  void* volatile memory = std::malloc(1);
  std::free(memory);
  counts.on = false;
  counts.only_in_jobs = in_jobs;
  return std::exchange(counts.heap, before) != before;
}

[[nodiscard]] inline std::uint64_t page_faults_so_far() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return static_cast<std::uint64_t>(usage.ru_minflt + usage.ru_majflt);
}

}  // namespace detail

/// The cost of `code` on this thread; `only_in_jobs`: only the heap and system calls within jobs of
/// components count.
template <typename Code>
JobCost cost_of(Code&& code, bool only_in_jobs = false) {
  detail::CostCounts& counts = detail::cost_counts();
  const bool heap = detail::heap_is_counted();
  const bool calls = detail::arm_dispatch(counts);
  counts.only_in_jobs = only_in_jobs;
  counts.heap = counts.calls = 0;
  const std::uint64_t faults = detail::page_faults_so_far();
  counts.on = true;
  counts.dispatch = calls ? 1 : 0;
  std::forward<Code>(code)();
  counts.dispatch = 0;
  counts.on = false;
  JobCost cost;
  cost.page_faults = detail::page_faults_so_far() - faults;
  if (heap) cost.heap_calls = counts.heap;
  if (calls) cost.system_calls = counts.calls;
  return cost;
}

}  // namespace mauve

#if MAUVE_COUNTS_HEAP
// Inline functions are weak symbols: a program that has its own malloc() keeps it, and heap calls
// are not counted.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* memory);

[[gnu::used]] inline void* malloc(std::size_t size) {
  return mauve::detail::count_heap_call(), __libc_malloc(size);
}
[[gnu::used]] inline void* calloc(std::size_t count, std::size_t size) {
  return mauve::detail::count_heap_call(), __libc_calloc(count, size);
}
[[gnu::used]] inline void* realloc(void* memory, std::size_t size) {
  return mauve::detail::count_heap_call(), __libc_realloc(memory, size);
}
[[gnu::used]] inline void* aligned_alloc(std::size_t alignment, std::size_t size) {
  return mauve::detail::count_heap_call(), __libc_memalign(alignment, size);
}
[[gnu::used]] inline void free(void* memory) {
  if (memory != nullptr) mauve::detail::count_heap_call();
  __libc_free(memory);
}
}
#endif
