// SPDX-License-Identifier: LGPL-3.0-or-later
#include "bench/support/machine.h"

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>

#include <pthread.h>
#include <sched.h>
#include <sys/utsname.h>
#include <time.h>
#include <unistd.h>

#include "rt/thread/futex.h"
#include "rt/time/ticks.h"

namespace bench {
namespace {

namespace fs = std::filesystem;

std::string first_line(const fs::path& path, const std::string& otherwise) {
  std::ifstream file(path);
  std::string line;
  return std::getline(file, line) ? line : otherwise;
}

std::string cpu_info(const std::string& key) {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (line.rfind(key, 0) == 0) return line.substr(line.find(':') + 2);
  }
  return "unknown";
}

/// "name 50" for a SCHED_FIFO thread, else empty. proc(5): fields 40 and 41 of stat.
std::string fifo_thread(const fs::path& task) {
  const std::string stat = first_line(task / "stat", "");
  const auto open = stat.find('(');
  const auto close = stat.rfind(')');
  if (close == std::string::npos) return {};
  std::istringstream fields(stat.substr(close + 1));
  std::string field;
  for (int i = 3; i < 40; ++i) fields >> field;
  int priority = 0;
  int policy = 0;
  fields >> priority >> policy;
  if (policy != SCHED_FIFO) return {};
  return stat.substr(open + 1, close - open - 1) + " " + std::to_string(priority);
}

std::string foreign_fifo_threads() {
  std::string list;
  std::error_code ignored;
  for (const auto& process : fs::directory_iterator("/proc", ignored)) {
    const std::string pid = process.path().filename();
    if (pid.find_first_not_of("0123456789") != std::string::npos) continue;
    if (pid == std::to_string(getpid())) continue;
    for (const auto& task : fs::directory_iterator(process.path() / "task", ignored)) {
      const std::string found = fifo_thread(task.path());
      if (!found.empty()) list += (list.empty() ? "" : ", ") + found;
    }
  }
  return list.empty() ? "none" : list;
}

cpu_set_t only(int cpu) {
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(static_cast<std::size_t>(cpu), &set);
  return set;
}

}  // namespace

std::string describe_machine() {
  utsname system{};
  uname(&system);
  const bool is_virtual = cpu_info("flags").find(" hypervisor") != std::string::npos;
  return "Machine: " + cpu_info("model name") + ", " +
         std::to_string(std::thread::hardware_concurrency()) + " CPUs" +
         (is_virtual ? " (virtual)" : "") + "; " + system.sysname + " " + system.release + " " +
         system.version + "; clock source " +
         first_line("/sys/devices/system/clocksource/clocksource0/current_clocksource", "unknown") +
         "; governor " +
         first_line("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "none") + "; load " +
         first_line("/proc/loadavg", "unknown") +
         "; SCHED_FIFO here: " + (fifo_or_none(1) > 0 ? "yes" : "NO, timing means nothing") +
         "; SCHED_FIFO threads of others: " + foreign_fifo_threads() + ".";
}

Instant now() {
  timespec t{};
  clock_gettime(CLOCK_MONOTONIC, &t);
  return static_cast<Instant>(t.tv_sec) * 1'000'000'000 + t.tv_nsec;
}

Instant processor_time() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<Instant>(t.tv_sec) * 1'000'000'000 + t.tv_nsec;
}

double kilobytes(const char* file, const std::string& key) {
  std::ifstream lines(file);
  for (std::string word; lines >> word;) {
    if (double value = 0; word == key && lines >> value) return value;
  }
  return 0;
}

void tie_ticks() {
  const Instant end = now() + 250'000'000;
  while (now() < end) {
    mauve::rt::tie_ticks();
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

int fifo_or_none(int wanted) { return mauve::rt::may_use_fifo(wanted) ? wanted : 0; }

OnCpu::OnCpu(int cpu, int priority) {
  const cpu_set_t set = only(cpu);
  pthread_setaffinity_np(pthread_self(), sizeof set, &set);
  sched_param parameter{};
  parameter.sched_priority = priority;
  if (priority > 0) pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameter);
}

OnCpu::~OnCpu() {
  const sched_param normal{};
  pthread_setschedparam(pthread_self(), SCHED_OTHER, &normal);
  cpu_set_t all;
  CPU_ZERO(&all);
  for (std::size_t cpu = 0; cpu < CPU_SETSIZE; ++cpu) CPU_SET(cpu, &all);
  pthread_setaffinity_np(pthread_self(), sizeof all, &all);
}

Probe::Probe(Instant phase, Duration period) : period_(period) {
  const int priority = fifo_or_none(99);
  const Instant periods = (now() - phase) / period_.count() + 4;
  const Instant due = phase + periods * period_.count();
  for (const int cpu : mauve::rt::usable_cpus()) {
    Watch& watch = watches_.emplace_back();
    watch.cpu = cpu;
    // Without the right to be first it would accuse everybody.
    if (priority == 0) continue;
    static_cast<void>(watch.thread.start({"bench-probe", priority, {cpu}},
                                         [this, &watch, due] { run(watch, due); }));
  }
}

Probe::~Probe() {
  quit_.store(true);
  for (Watch& watch : watches_) watch.thread.join();
}

void Probe::run(Watch& watch, Instant due) {
  const std::atomic<std::uint32_t> nobody_wakes{0};
  for (; !quit_.load(std::memory_order_relaxed); due += period_.count()) {
    mauve::rt::futex_wait_until(nobody_wakes, 0, due);
    const Instant woke = now();
    const std::size_t count = watch.count.load(std::memory_order_relaxed);
    if (woke - due <= kTolerance.count() || count == watch.windows.size()) continue;
    watch.windows[count] = {due - period_.count(), woke + period_.count()};
    watch.count.store(count + 1, std::memory_order_release);
  }
}

bool Probe::disturbed(int cpu, Instant from, Instant to) const {
  for (const Watch& watch : watches_) {
    if (watch.cpu != cpu) continue;
    const std::size_t count = watch.count.load(std::memory_order_acquire);
    for (std::size_t i = 0; i < count; ++i) {
      if (watch.windows[i].from <= to && from <= watch.windows[i].to) return true;
    }
  }
  return false;
}

std::size_t Probe::windows() const {
  std::size_t all = 0;
  for (const Watch& watch : watches_) all += watch.count.load(std::memory_order_acquire);
  return all;
}

}  // namespace bench
