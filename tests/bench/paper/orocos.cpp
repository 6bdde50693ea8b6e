// SPDX-License-Identifier: LGPL-3.0-or-later
/// The paper's Orocos rows, with Orocos RTT 2 (gnulinux):
///   `paper_orocos bg|prio|isolated CPU COUNT`.
/// The program has two periodic TaskContexts as in Table 1. A deployer thread starts A first. This
/// thread has less priority than both, or more, or a CPU of its own. The program prints
/// "launch NAME instant" and, for each cycle, "NAME start end".
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include <pthread.h>
#include <sched.h>
#include <time.h>

#include <rtt/os/fosi.h>
#include <rtt/os/main.h>
#include <rtt/Activity.hpp>
#include <rtt/TaskContext.hpp>

namespace {

long long read_clock(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return static_cast<long long>(time.tv_sec) * 1'000'000'000 + time.tv_nsec;
}
long long now() { return read_clock(CLOCK_MONOTONIC); }

class Computing : public RTT::TaskContext {
 public:
  Computing(const std::string& name, long long time) : RTT::TaskContext(name), time_(time) {
    cycles_.reserve(4096);
  }
  void updateHook() override {
    const long long start = now();
    const long long end = read_clock(CLOCK_THREAD_CPUTIME_ID) + time_;
    while (read_clock(CLOCK_THREAD_CPUTIME_ID) < end) {
    }
    if (cycles_.size() < cycles_.capacity()) cycles_.emplace_back(start, now());
  }
  void print() const {
    for (const auto& [start, end] : cycles_) {
      std::printf("%s %lld %lld\n", getName().c_str(), start, end);
    }
  }

 private:
  long long time_;
  std::vector<std::pair<long long, long long>> cycles_;
};

void schedule_deployer(const std::string& variant, int cpu) {
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(variant == "isolated" ? 0 : cpu, &set);
  sched_setaffinity(0, sizeof set, &set);
  sched_param parameter{};
  parameter.sched_priority = variant == "bg" ? 0 : 80;
  pthread_setschedparam(pthread_self(), variant == "bg" ? SCHED_OTHER : SCHED_FIFO, &parameter);
}

void wait(long long nanoseconds) {
  const timespec time{static_cast<time_t>(nanoseconds / 1'000'000'000),
                      static_cast<long>(nanoseconds % 1'000'000'000)};
  nanosleep(&time, nullptr);
}

}  // namespace

int ORO_main(int argc, char** argv) {
  if (argc < 4) return 2;
  const int cpu = std::atoi(argv[2]);
  const unsigned mask = 1U << static_cast<unsigned>(cpu);
  schedule_deployer(argv[1], cpu);
  Computing a("a", 20'000'000);
  Computing b("b", 10'000'000);
  a.setActivity(new RTT::Activity(ORO_SCHED_RT, 20, 0.1, mask, nullptr, "a"));
  b.setActivity(new RTT::Activity(ORO_SCHED_RT, 50, 0.1, mask, nullptr, "b"));
  if (!a.configure() || !b.configure()) return 1;
  const long long launch_a = now();
  a.start();
  const long long launch_b = now();
  b.start();
  wait(std::atoll(argv[3]) * 100'000'000);
  a.stop();
  b.stop();
  std::printf("launch a %lld\nlaunch b %lld\n", launch_a, launch_b);
  a.print();
  b.print();
  return 0;
}
