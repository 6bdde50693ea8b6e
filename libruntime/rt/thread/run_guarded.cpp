// SPDX-License-Identifier: LGPL-3.0-or-later
#include "rt/thread/run_guarded.h"

#include "rt/thread/float_environment.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csetjmp>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <string_view>

#include <link.h>
#include <locale.h>
#include <sys/syscall.h>
#include <ucontext.h>
#include <unistd.h>

#include "base/mutex.h"
#include "rt/thread/crash_handler.h"

namespace mauve::rt {
namespace {

/// SIGABRT is always sent: by std::terminate(), a failed assertion, a corrupt heap.
constexpr std::array<int, 5> kFaults{SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};

struct Frame {
  sigjmp_buf buffer;
  const Watched* watched;
  Frame* outer;
  Fault fault;
  sigset_t mask;  // from before the body, once that changes it
  bool mask_kept = false;
};

/// Not by pthread_sigmask(), which libmauve has replaced for bodies.
void set_mask(int how, const sigset_t* set, sigset_t* before) {
  constexpr std::size_t kSignalBytes = 8;
  syscall(SYS_rt_sigprocmask, how, set, before, kSignalBytes);
}

/// A body may change this of its thread, and no call of it could be refused.
class ThreadState {
 public:
  void put_back() const {
    floats_.put_back();
    if (uselocale(nullptr) != locale_) uselocale(locale_);
  }

 private:
  FloatEnvironment floats_;
  locale_t locale_ = uselocale(nullptr);
};

/// Of the innermost body that this thread runs; null: none.
Frame*& this_frame() {
  [[gnu::tls_model("initial-exec")]] static thread_local Frame* frame = nullptr;
  return frame;
}

struct Range {
  std::uintptr_t begin;
  std::uintptr_t end;
};

/// Executable ranges, filled before the handlers are installed.
class Ranges {
 public:
  void add(Range range) {
    if (count_ < ranges_.size()) ranges_[count_++] = range;
  }
  [[nodiscard]] bool contain(std::uintptr_t address) const {
    const auto* end = ranges_.data() + count_;
    return std::any_of(ranges_.data(), end, [address](const Range& range) {
      return range.begin <= address && address < range.end;
    });
  }

 private:
  std::array<Range, 24> ranges_{};
  std::size_t count_ = 0;
};

/// The process whose bodies these are. A child that a body forked has no caller to return to.
std::atomic<pid_t> owner{0};

struct Code {
  Ranges system;   // may hold locks of its own
  Ranges runtime;  // may be in the middle of a hand-over, so the guard does not interrupt it
};
Code code;

bool is_system(std::string_view path) {
  const std::string_view file = path.substr(path.rfind('/') + 1);
  constexpr std::array<std::string_view, 8> kNames{
      "libc.", "libc-", "ld-", "libpthread", "libdl.", "libstdc++.", "libgcc_s.", "linux-vdso"};
  return std::any_of(kNames.begin(), kNames.end(),
                     [file](std::string_view name) { return file.rfind(name, 0) == 0; });
}

int collect(dl_phdr_info* object, std::size_t /*size*/, void* /*unused*/) {
  const auto here = reinterpret_cast<std::uintptr_t>(&collect);
  const bool system = object->dlpi_name != nullptr && is_system(object->dlpi_name);
  for (int i = 0; i < object->dlpi_phnum; ++i) {
    const ElfW(Phdr)& part = object->dlpi_phdr[i];
    if (part.p_type != PT_LOAD || (part.p_flags & PF_X) == 0) continue;
    const std::uintptr_t begin = object->dlpi_addr + part.p_vaddr;
    const Range range{begin, begin + part.p_memsz};
    if (system) code.system.add(range);
    if (range.begin <= here && here < range.end) code.runtime.add(range);
  }
  return 0;
}

std::uintptr_t instruction_of(const void* context) {
  const auto& machine = static_cast<const ucontext_t*>(context)->uc_mcontext;
#if defined(__x86_64__)
  return static_cast<std::uintptr_t>(machine.gregs[REG_RIP]);
#elif defined(__aarch64__)
  return machine.pc;
#else
  static_cast<void>(machine);
  return 0;
#endif
}

sigset_t all_of_ours() {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : kSignalsOfBodies) sigaddset(&set, signal);
  return set;
}

/// Back to where the body was called.
[[noreturn]] void abort_job(Frame& frame, const Fault& fault) {
  frame.fault = fault;
  this_frame() = frame.outer;
  const sigset_t set = all_of_ours();
  set_mask(SIG_UNBLOCK, &set, nullptr);
  siglongjmp(frame.buffer, 1);
}

void on_fault(int signal, siginfo_t* info, void* context) {
  const Fault fault{signal, reinterpret_cast<std::uintptr_t>(info->si_addr), false,
                    info->si_code <= 0};
  Frame* const frame = this_frame();
  const bool contained = frame != nullptr && getpid() == owner.load() && !fault.sent &&
                         !code.system.contain(instruction_of(context));
  if (contained) abort_job(*frame, fault);
  forget_bodies();
  run_crash_handler(fault);
  std::signal(signal, SIG_DFL);
  if (fault.sent) raise(signal);
  // The instruction that failed fails again, and the process dies of it, with a core dump.
}

void on_interrupt(int signal, siginfo_t* /*info*/, void* context) {
  const std::uintptr_t at = instruction_of(context);
  if (code.system.contain(at) || code.runtime.contain(at)) return;
  // The job may run a nested body, whose caller must learn that the body did not end. So the nested
  // body ends first, and the job ends when the guard signals it again.
  for (const Frame* frame = this_frame(); frame != nullptr; frame = frame->outer) {
    const Instant wanted = frame->watched->interrupt.load();
    const bool meant = wanted != 0 && wanted == frame->watched->busy_since.load();
    if (meant) abort_job(*this_frame(), {signal, at, true, false});
  }
}

struct Installed {
  Mutex mutex;
  std::size_t users MAUVE_GUARDED_BY(mutex) = 0;
  std::array<struct sigaction, kFaults.size()> faults{};
  struct sigaction interrupt {};
};

Installed& installed() {
  static Installed one;
  return one;
}

void install(Installed& before) {
  owner.store(getpid());
  code = Code{};
  dl_iterate_phdr(collect, nullptr);
  struct sigaction action {};
  action.sa_flags = SA_SIGINFO | SA_ONSTACK | SA_RESTART;
  action.sa_mask = all_of_ours();
  action.sa_sigaction = on_fault;
  for (std::size_t i = 0; i < kFaults.size(); ++i)
    sigaction(kFaults[i], &action, &before.faults[i]);
  action.sa_sigaction = on_interrupt;
  sigaction(kInterrupt, &action, &before.interrupt);
}

}  // namespace

void describe(const Fault& fault, char* text, std::size_t room) {
  const char* const abbreviation = sigabbrev_np(fault.signal);
  std::array<char, 24> name{};
  if (abbreviation != nullptr) {
    std::snprintf(name.data(), name.size(), "SIG%s", abbreviation);
  } else {  // a real-time signal
    std::snprintf(name.data(), name.size(), "signal %d", fault.signal);
  }
  if (fault.call != nullptr && fault.status != 0) {
    std::snprintf(text, room, "%s(%d)", fault.call, fault.status);
  } else if (fault.call != nullptr) {
    std::snprintf(text, room, "%s()%s%s", fault.call, fault.because != nullptr ? ", " : "",
                  fault.because != nullptr ? fault.because : "");
  } else if (fault.signal == 0) {
    std::snprintf(text, room, "exit()");
  } else if (fault.sent) {
    std::snprintf(text, room, "%s", name.data());
  } else {
    std::snprintf(text, room, "%s at address 0x%lx", name.data(),
                  static_cast<unsigned long>(fault.address));
  }
}

Fault run_guarded(void (*body)(void*), void* argument, const Watched& watched) {
  const ThreadState before;
  use_default_float_environment();
  if constexpr (!kGuardsFaults) {
    body(argument);
    before.put_back();
    return {};
  }
  Frame frame;
  frame.watched = &watched;
  frame.outer = this_frame();
  if (sigsetjmp(frame.buffer, 0) == 0) {
    this_frame() = &frame;
    body(argument);
    this_frame() = frame.outer;
  }
  before.put_back();
  if (frame.mask_kept) set_mask(SIG_SETMASK, &frame.mask, nullptr);
  return frame.fault;
}

void keep_mask() {
  Frame* const frame = this_frame();
  if (frame == nullptr || frame->mask_kept) return;
  set_mask(SIG_BLOCK, nullptr, &frame->mask);
  frame->mask_kept = true;
}

void forget_bodies() { this_frame() = nullptr; }

bool in_body() { return this_frame() != nullptr; }

void end_body(const Fault& fault) {
  if (Frame* const frame = this_frame()) abort_job(*frame, fault);
}

FaultHandlers::FaultHandlers() {
  if constexpr (!kGuardsFaults) return;
  Installed& all = installed();
  const MutexLock lock(all.mutex);
  if (all.users++ == 0) install(all);
}

FaultHandlers::~FaultHandlers() {
  if constexpr (!kGuardsFaults) return;
  Installed& all = installed();
  const MutexLock lock(all.mutex);
  if (--all.users > 0) return;
  for (std::size_t i = 0; i < kFaults.size(); ++i) sigaction(kFaults[i], &all.faults[i], nullptr);
  sigaction(kInterrupt, &all.interrupt, nullptr);
}

FaultStack::FaultStack() {
  if constexpr (!kGuardsFaults) return;
  const long smallest = sysconf(_SC_MINSIGSTKSZ);
  const std::size_t size = 16 * 1024 + static_cast<std::size_t>(std::max(smallest, 0L));
  memory_ = std::make_unique<std::byte[]>(size);  // touched
  const stack_t stack{memory_.get(), 0, size};
  sigaltstack(&stack, nullptr);
}

FaultStack::~FaultStack() {
  if (memory_ == nullptr) return;
  stack_t none{};
  none.ss_flags = SS_DISABLE;
  sigaltstack(&none, nullptr);
}

}  // namespace mauve::rt
