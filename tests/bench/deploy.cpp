// SPDX-License-Identifier: LGPL-3.0-or-later
/// From the common T0 to two running tasks; the deployment of 500 components and their memory.
/// The latter in a child process each time: an allocator and a cache of stacks that were used
/// before would flatter it.
#include <algorithm>
#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include "bench/support/checked.h"
#include "bench/support/fresh.h"
#include "bench/support/machine.h"
#include "bench/support/many.h"
#include "bench/support/raw.h"
#include "bench/support/report.h"
#include "rt/process/memory.h"
#include "rt/thread/futex.h"

#include <mauve/host/deployer.h>

namespace bench {
namespace {

constexpr int kPriority = Many::kPriority;

double two_tasks() {
  Many architecture(2);
  mauve::Deployer deployer(architecture);
  must(deployer.deploy());
  const double last = architecture.last_began(deployer.t0());
  static_cast<void>(deployer.shutdown());
  return last;
}

/// Threads that wait for one instant, and no more.
class RawThreads {
 public:
  explicit RawThreads(int count)
      : threads_(static_cast<std::size_t>(count)), began_(threads_.size()) {
    const std::vector<int> cpus = mauve::rt::usable_cpus();
    const int priority = fifo_or_none(kPriority);
    for (std::size_t i = 0; i < threads_.size(); ++i) {
      must(threads_[i].start({"bench-raw", priority, {cpus[i % cpus.size()]}}, [this, i] {
        parked_.fetch_add(1);
        while (t0_.load() == 0) mauve::rt::futex_wait_until(gate_, 0, mauve::rt::kForever);
        mauve::rt::futex_wait_until(nobody_wakes_, 0, t0_.load());
        began_[i].store(now());
        begun_.fetch_add(1);
        while (!over_.load()) mauve::rt::futex_wait_until(gate_, 1, mauve::rt::kForever);
      }));
    }
    while (parked_.load() < count) std::this_thread::yield();
  }
  /// Lets them go; how long after T0 the last one began, in us.
  double release() {
    const Instant t0 = now() + 200'000 + 5'000 * static_cast<Instant>(threads_.size());
    t0_.store(t0);
    mauve::rt::futex_bump(gate_);
    while (begun_.load() < threads_.size()) std::this_thread::yield();
    over_.store(true);
    mauve::rt::futex_bump(gate_);
    for (auto& thread : threads_) thread.join();
    Instant last = 0;
    for (const auto& began : began_) last = std::max(last, began.load());
    return static_cast<double>(last - t0) / 1e3;
  }

 private:
  std::vector<mauve::rt::Thread> threads_;
  std::vector<std::atomic<Instant>> began_;
  std::atomic<int> parked_{0};
  std::atomic<std::size_t> begun_{0};
  std::atomic<bool> over_{false};
  std::atomic<std::uint32_t> gate_{0};
  std::atomic<std::uint32_t> nobody_wakes_{0};
  std::atomic<Instant> t0_{0};
};

/// The same number of bare threads: created, parked, let go.
Deployment raw_many(int count) {
  must(mauve::rt::lock_memory());
  const double resident = kilobytes("/proc/self/status", "VmRSS:");
  const Instant start = now();
  RawThreads threads(count);
  Deployment result;
  result.milliseconds = static_cast<double>(now() - start) / 1e6;
  result.resident = (kilobytes("/proc/self/status", "VmRSS:") - resident) / count;
  result.last_began = threads.release();
  return result;
}

void measure_many(Report& report, const Options& options, int count, Target promised_time) {
  const std::string text = std::to_string(count) + " components: ";
  Figure& time = report.figure(text + "deploy()", "ms", promised_time);
  Figure& last = report.figure(text + "T0 until the last runs", "us");
  Figure& memory = report.figure(text + "resident memory of each", "kB", at_most(160));
  Figure& kernel = report.figure(text + "kernel stack of each", "kB");
  Figure& shutdown = report.figure(text + "shutdown()", "ms");
  for (int i = 0; i < options.rounds; ++i) {
    const Deployment ours = in_child<Deployment>([&] { return deploy_many(count); });
    const Deployment raw = in_child<Deployment>([&] { return raw_many(count); });
    time.add(ours.milliseconds, raw.milliseconds);
    last.add(ours.last_began, raw.last_began);
    memory.add(ours.resident, raw.resident);
    kernel.add(ours.kernel_stack);
    shutdown.add(ours.shutdown);
  }
}

void measure_two(Report& report, const Options& options) {
  Figure& both = report.figure("2 components: T0 until both run", "us", at_most(30));
  for (int i = 0; i < options.rounds; ++i) {
    std::vector<double> ours;
    std::vector<double> raw;
    for (int j = 0; j < options.choose(20, 3); ++j) {
      ours.push_back(two_tasks());
      raw.push_back(RawThreads(2).release());
    }
    both.add(median(ours), median(raw));
  }
}

void run(const Options& options) {
  Report report("deploy",
                "Deployment against bare threads that are created in the same way, parked, and "
                "wait for the same T0.",
                options);
  // First: children of a process without threads.
  measure_many(report, options, 10, {});
  measure_many(report, options, options.choose(500, 20), at_most(80));
  measure_two(report, options);
  report.print();
}

}  // namespace
}  // namespace bench

int main(int argc, char** argv) { bench::run(bench::parse(argc, argv)); }
