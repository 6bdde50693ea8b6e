// SPDX-License-Identifier: LGPL-3.0-or-later
#include "bench/support/many.h"

#include <algorithm>
#include <string>
#include <thread>

#include "bench/support/checked.h"
#include "rt/process/memory.h"

#include <mauve/host/deployer.h>

namespace bench {

Many::Many(int count, Duration period, const std::vector<int>& cpus) {
  for (int i = 0; i < count; ++i) {
    auto& made = *components.emplace_back(
        std::make_unique<Component>(*this, "component" + std::to_string(i)));
    made.fsm().period = period;
    made.task().priority = kPriority;
    made.task().cpus = {cpus[static_cast<std::size_t>(i) % cpus.size()]};
  }
}

double Many::last_began(Instant t0) const {
  Instant last = 0;
  for (const auto& component : components) {
    while (component->core().first.load() == 0) std::this_thread::yield();
    last = std::max(last, component->core().first.load());
  }
  return static_cast<double>(last - t0) / 1e3;
}

std::uint64_t Many::jobs() const {
  std::uint64_t all = 0;
  for (const auto& component : components) all += component->core().jobs.load();
  return all;
}

double Many::job_takes(Duration time) const {
  const std::uint64_t jobs_before = jobs();
  const Instant before = processor_time();
  std::this_thread::sleep_for(time);
  const Instant took = processor_time() - before;
  const std::uint64_t done = jobs() - jobs_before;
  return done == 0 ? 0 : static_cast<double>(took) / static_cast<double>(done) / 1e3;
}

Deployment deploy_many(int count, Duration period, Duration run) {
  must(mauve::rt::lock_memory());
  const double resident = kilobytes("/proc/self/status", "VmRSS:");
  const double kernel = kilobytes("/proc/meminfo", "KernelStack:");
  Many architecture(count, period);
  mauve::Deployer deployer(architecture);
  const Instant start = now();
  must(deployer.deploy());
  Deployment result;
  result.milliseconds = static_cast<double>(now() - start) / 1e6;
  result.last_began = architecture.last_began(deployer.t0());
  result.resident = (kilobytes("/proc/self/status", "VmRSS:") - resident) / count;
  result.kernel_stack = (kilobytes("/proc/meminfo", "KernelStack:") - kernel) / count;
  if (run > Duration{0}) result.job = architecture.job_takes(run);
  const Instant end = now();
  static_cast<void>(deployer.shutdown(std::chrono::seconds(20)));
  result.shutdown = static_cast<double>(now() - end) / 1e6;
  return result;
}

}  // namespace bench
