// SPDX-License-Identifier: LGPL-3.0-or-later
/// Guarded run: a fault of user code (SIGSEGV, SIGBUS, SIGFPE, SIGILL) ends the body it happened
/// in, not the process. A guard may also end a body that does not return. No destructor of an
/// object on the stack runs. This does not hold for a fault in code of the system, which may hold
/// locks of its own, nor when the code itself aborts (SIGABRT). Then the crash handler writes the
/// safe values and the process dies.
#pragma once

#include <array>
#include <atomic>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <memory>

#include <mauve/time.h>

namespace mauve::rt {

/// Sanitizers have handlers of their own.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kGuardsFaults = false;
#elif defined(__x86_64__) || defined(__aarch64__)
inline constexpr bool kGuardsFaults = true;
#else
inline constexpr bool kGuardsFaults = false;
#endif

/// The signal that makes a thread look whether its body shall end. Ignored unless handled, and of
/// no other use in a process without out-of-band data.
inline constexpr int kInterrupt = SIGURG;

/// Why a body did not end by itself.
struct Fault {
  int signal = 0;  ///< 0: none
  std::uintptr_t address = 0;
  bool interrupted = false;    ///< by the guard
  bool sent = false;           ///< by kill(), not by an instruction
  const char* call = nullptr;  ///< it called this function, which ends a thread or the process
  const char* because =
      nullptr;     ///< the function ends nothing, and may not be called for this reason
  int status = 0;  ///< the argument of exit()

  [[nodiscard]] bool happened() const { return signal != 0 || call != nullptr; }
};

/// "SIGSEGV at address 0x10" or "exit(3)", cut to the room there is. Async-signal-safe enough for
/// the crash handler.
void describe(const Fault& fault, char* text, std::size_t room);

/// The signals of faults, and kInterrupt: a body that blocked one could not be ended.
inline constexpr std::array<int, 6> kSignalsOfBodies{SIGSEGV, SIGBUS,  SIGFPE,
                                                     SIGILL,  SIGABRT, kInterrupt};

/// The view of a guard on a thread that runs bodies.
struct Watched {
  std::atomic<Instant> busy_since{0};     ///< when the body began, never the same twice; 0: idle
  std::atomic<Instant> interrupt{0};      ///< the body that began then shall not go on
  std::atomic<bool> keeps_thread{false};  ///< the guard never abandons the thread
};

/// Of a body that no guard looks at.
inline const Watched kUnwatched;

/// Runs `body`, which must not throw; one body may run others. A fault in its own code ends it, and
/// so does a call of abort(), exit(), quick_exit(), _exit() or pthread_exit(), a failed assertion
/// or std::terminate(). So does a call that changes the whole process (rt/calls). A fault
/// inside the C library does not: that may hold locks of its own. The body begins in the default
/// floating-point environment, whatever ran on this thread before. This environment, the locale of
/// the thread and its signal mask are behind the body as they were before it. [rt]
[[nodiscard]] Fault run_guarded(void (*body)(void*), void* argument, const Watched& watched);

/// Does the calling thread run a body?
[[nodiscard]] bool in_body();

/// The body that the calling thread runs is about to change the signal mask of the thread.
void keep_mask();

/// Ends the body that the calling thread runs with this fault; without one it returns.
void end_body(const Fault& fault);

/// The process ends: the calling thread runs no body any more that could end before it.
void forget_bodies();

/// While one lives, the process handles faults; the handlers from before are back after the last
/// one. Not on real-time threads.
class FaultHandlers {
 public:
  FaultHandlers();
  ~FaultHandlers();
  FaultHandlers(const FaultHandlers&) = delete;
  FaultHandlers& operator=(const FaultHandlers&) = delete;
};

/// The stack that the calling thread handles faults on, so that a full stack is one that can be
/// handled. First thing in a thread, touched; removed at the end of the scope.
class FaultStack {
 public:
  FaultStack();
  ~FaultStack();
  FaultStack(const FaultStack&) = delete;
  FaultStack& operator=(const FaultStack&) = delete;

 private:
  std::unique_ptr<std::byte[]> memory_;
};

}  // namespace mauve::rt
