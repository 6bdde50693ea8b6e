// SPDX-License-Identifier: LGPL-3.0-or-later
/// Real-time threads and the privileges they need.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include <pthread.h>

#include <mauve/result.h>
#include <mauve/time.h>

namespace mauve::rt {

/// How a thread is created. Priority 0: not real-time (SCHED_OTHER).
struct ThreadAttributes {
  std::string name;               ///< at most 15 characters are shown by the system
  int priority = 0;               ///< SCHED_FIFO
  std::vector<int> cpus;          ///< empty: anywhere
  std::size_t stack = 64 * 1024;  ///< bytes; touched before the body runs
  bool as_used = false;           ///< not touched, and see LockedAsUsed: no real-time thread
};

/// A joinable thread with explicit stack, policy and CPUs.
class Thread {
 public:
  Thread() = default;
  ~Thread();
  Thread(const Thread&) = delete;
  Thread& operator=(const Thread&) = delete;

  /// Starts `body`. Errors name the missing privilege.
  Status start(const ThreadAttributes& attributes, std::function<void()> body);
  [[nodiscard]] bool running() const { return running_ && !finished_.load(); }
  /// Waits for the end of the body.
  void join();
  /// Joins a thread that has ended, which takes longer than the end of its body: no urgent thread
  /// waits for the last steps of an ordinary one. True: there is nothing more to join.
  [[nodiscard]] bool join_if_ended();
  /// Gives up on a thread that does not end. The thread uses this object as long as it runs.
  void abandon();
  /// The policy and priority the system really gave it: true when SCHED_FIFO at `priority`.
  [[nodiscard]] bool is_fifo(int priority) const;
  /// It is SCHED_FIFO of this priority and on these CPUs (empty: any), also for a system that was
  /// asked past the C library, which remembers only its own calls. [any]
  [[nodiscard]] bool keeps(int priority, const std::vector<int>& cpus) const;
  /// Changes the priority of a running thread (also demotion to 0). [control]
  Status set_priority(int priority);
  /// Processor time that its body used so far. [any]
  [[nodiscard]] Duration used() const;
  /// It neither runs nor waits for a processor, but for something else; reads a file of the system.
  [[nodiscard]] bool asleep() const;
  /// Makes it look whether its body shall end where it is, see run_guarded.h. [any]
  void interrupt();
  Status set_cpus(const std::vector<int>& cpus);

 private:
  static void* enter(void* self);

  pthread_t handle_{};
  std::size_t stack_ = 0;
  bool as_used_ = false;
  std::function<void()> body_;
  std::atomic<bool> finished_{false};
  std::atomic<int> id_{0};
  bool running_ = false;
};

/// May this process create SCHED_FIFO threads of this priority? The error names the missing
/// privilege and how to grant it.
[[nodiscard]] Status may_use_fifo(int priority);

/// CPUs that this process may use.
[[nodiscard]] std::vector<int> usable_cpus();

/// Is `cpu` one of them? `at` is the address in the refusal.
[[nodiscard]] Status check_cpu(int cpu, const std::string& at);

/// SCHED_FIFO of this priority for a thread of the C++ library, where it is permitted; 0: ordinary.
/// The error number of the system, or 0. [any]
int give_priority(pthread_t thread, int priority);
/// The same for the calling thread until it ends; 0: nothing is asked of the system.
void raise_this_thread(int priority);

/// Raises the calling thread to SCHED_FIFO for a scope, where permitted.
class Boost {
 public:
  explicit Boost(int priority);
  ~Boost();
  Boost(const Boost&) = delete;
  Boost& operator=(const Boost&) = delete;

 private:
  bool raised_ = false;
};

}  // namespace mauve::rt
