// SPDX-License-Identifier: LGPL-3.0-or-later
/// Table 1 of the paper: two periodic tasks that only compute, and a process that disturbs them.
/// All on one CPU; A is launched first.
#pragma once

#include <string>
#include <vector>

#include <sys/types.h>

#include "bench/support/machine.h"

namespace bench::paper {

using namespace std::chrono_literals;

struct Task {
  const char* name;
  int priority;
  Duration period;
  Duration time;  // to compute
};
inline constexpr Task kA{"a", 20, 100ms, 20ms};
inline constexpr Task kB{"b", 50, 100ms, 10ms};

/// One job. Preemptions are inside.
struct Cycle {
  Instant start;
  Instant end;
};

/// Of one task, noted by its own thread.
class Cycles {
 public:
  Cycles() { cycles_.reserve(1 << 12); }
  void add(Instant start, Instant end) {
    if (cycles_.size() < cycles_.capacity()) cycles_.push_back({start, end});
  }
  /// When its thread has ended.
  [[nodiscard]] const std::vector<Cycle>& all() const { return cycles_; }

 private:
  std::vector<Cycle> cycles_;
};

/// Uses so much processor time, by the clock of the thread: what the kernel accounts to a process
/// (the paper's getrusage) moves in ticks on some kernels.
void compute(Duration time);

/// Computes and notes it.
inline void job(const Task& task, Cycles& cycles) {
  const Instant start = now();
  compute(task.time);
  cycles.add(start, now());
}

/// One run of both.
struct Run {
  Instant launched_a = 0;  // the process, or what starts the threads
  Instant launched_b = 0;
  Instant reference = 0;  // of the clock; 0: there is no common one
  Instant t0 = 0;         // the first release
  std::vector<Cycle> a;
  std::vector<Cycle> b;
};

[[nodiscard]] Run run_mauve(int cpu, Duration time);
[[nodiscard]] Run run_raw(int cpu, Duration time);
/// A process for each task, as in ROS: `PROGRAM cycles NAME PERIOD_US TIME_US COUNT` prints a line
/// "NAME start end" for each cycle. Empty when it does not run.
[[nodiscard]] Run run_processes(const std::string& program, int cpu, Duration time);
/// A process for both: `PROGRAM VARIANT CPU COUNT` prints "launch NAME instant" too.
[[nodiscard]] Run run_process(const std::string& program, const std::string& variant, int cpu,
                              Duration time);
/// The output of a program.
[[nodiscard]] std::string output_of(const std::vector<std::string>& words, int cpu);

/// An ordinary process: every 10 ms it computes for 1 to 5 ms.
class Disturber {
 public:
  explicit Disturber(int cpu);
  ~Disturber();
  Disturber(const Disturber&) = delete;
  Disturber& operator=(const Disturber&) = delete;

 private:
  pid_t child_;
};

/// The calling thread, and what it starts, on one CPU.
void stay_on(int cpu);

}  // namespace bench::paper
