// SPDX-License-Identifier: LGPL-3.0-or-later
#include "bench/paper/tasks.h"

#include <algorithm>
#include <atomic>
#include <random>
#include <thread>

#include <sched.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "bench/support/checked.h"
#include "rt/thread/futex.h"

#include <mauve/host/architecture.h>
#include <mauve/host/deployer.h>

namespace bench::paper {
namespace {

/// Between the reference of the clock and T0: the threads park again meanwhile. As the runtime.
constexpr Duration kLead{200us + 2 * 5us};

Instant thread_time() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return Instant{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

struct Computing : mauve::Core<mauve::EmptyShell> {
  mauve::Stateless stateless{*this};
  const Task* task = nullptr;
  Cycles cycles;
  void update() { job(*task, cycles); }
};
using Component = mauve::Component<mauve::EmptyShell, Computing, mauve::PeriodicFsm<Computing>>;

struct TwoComponents : mauve::Architecture {
  explicit TwoComponents(int cpu) {
    prepare(a, kA, cpu);
    prepare(b, kB, cpu);
  }
  static void prepare(Component& component, const Task& task, int cpu) {
    component.core().task = &task;
    component.fsm().period = task.period;
    component.task().priority = task.priority;
    component.task().cpus = {cpu};
  }
  Component a{*this, "a"};
  Component b{*this, "b"};
};

/// A thread that parks on a gate, and then waits for absolute instants.
class RawTask {
 public:
  RawTask(const Task& task, int cpu, std::atomic<std::uint32_t>& gate, const Instant& t0)
      : task_(task) {
    must(thread_.start({task.name, fifo_or_none(task.priority), {cpu}}, [&gate, &t0, this] {
      parked_.store(true);
      while (gate.load() == 0) mauve::rt::futex_wait_until(gate, 0, mauve::rt::kForever);
      for (Instant due = t0; !over_.load(std::memory_order_relaxed); due += task_.period.count()) {
        while (now() < due) mauve::rt::futex_wait_until(nobody_wakes_, 0, due);
        job(task_, cycles_);
      }
    }));
    while (!parked_.load()) std::this_thread::yield();
  }
  /// All of them before one of them is waited for: the last jobs are as the others.
  void stop() { over_.store(true); }
  std::vector<Cycle> end() {
    thread_.join();
    return cycles_.all();
  }

 private:
  Task task_;
  Cycles cycles_;
  std::atomic<bool> parked_{false};
  std::atomic<bool> over_{false};
  std::atomic<std::uint32_t> nobody_wakes_{0};
  mauve::rt::Thread thread_;
};

}  // namespace

void compute(Duration time) {
  const Instant end = thread_time() + time.count();
  while (thread_time() < end) {
  }
}

Run run_mauve(int cpu, Duration time) {
  TwoComponents architecture(cpu);
  mauve::Deployer deployer(architecture);
  Run run;
  run.launched_a = run.launched_b = now();
  must(deployer.deploy());
  run.t0 = deployer.t0();
  run.reference = run.t0 - kLead.count();
  std::this_thread::sleep_for(time);
  static_cast<void>(deployer.shutdown());
  run.a = architecture.a.core().cycles.all();
  run.b = architecture.b.core().cycles.all();
  return run;
}

Run run_raw(int cpu, Duration time) {
  Run run;
  std::atomic<std::uint32_t> gate{0};
  run.launched_a = now();
  RawTask a(kA, cpu, gate, run.t0);
  run.launched_b = now();
  RawTask b(kB, cpu, gate, run.t0);
  {
    const mauve::rt::Boost first(98);
    run.reference = now();
    run.t0 = run.reference + kLead.count();
    mauve::rt::futex_bump(gate);
  }
  std::this_thread::sleep_for(time);
  a.stop();
  b.stop();
  run.b = b.end();
  run.a = a.end();
  return run;
}

Disturber::Disturber(int cpu) : child_(fork()) {
  if (child_ != 0) return;
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  stay_on(cpu);
  std::mt19937 random(1);
  std::uniform_int_distribution<int> time(1000, 5000);
  for (Instant due = now();; due += 10'000'000) {
    compute(std::chrono::microseconds(time(random)));
    const timespec until{static_cast<time_t>(due / 1'000'000'000),
                         static_cast<long>(due % 1'000'000'000)};
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr);
  }
}

Disturber::~Disturber() {
  kill(child_, SIGKILL);
  waitpid(child_, nullptr, 0);
}

void stay_on(int cpu) {
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(static_cast<std::size_t>(cpu), &set);
  sched_setaffinity(0, sizeof set, &set);
}

}  // namespace bench::paper
