// SPDX-License-Identifier: LGPL-3.0-or-later
/// Many: as many components that do nothing as a benchmark wants, and what deploying them costs.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "bench/support/machine.h"
#include "bench/support/raw.h"

#include <mauve/host/architecture.h>

namespace bench {

/// Notes when its jobs began: the first one, and all of them where there is room.
struct Beginning : mauve::Core<mauve::EmptyShell> {
  mauve::Stateless stateless{*this};
  std::atomic<Instant> first{0};
  std::atomic<std::uint64_t> jobs{0};
  Instants starts{0};
  void update() {
    const Instant began = now();
    if (first.load(std::memory_order_relaxed) == 0) first.store(began);
    jobs.store(jobs.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
    starts.add(began);
  }
};

/// "component0" and so on, one after the other over the CPUs.
struct Many : mauve::Architecture {
  static constexpr int kPriority = 50;
  using Component = mauve::Component<mauve::EmptyShell, Beginning, mauve::PeriodicFsm<Beginning>>;

  explicit Many(int count, Duration period = std::chrono::milliseconds(100),
                const std::vector<int>& cpus = mauve::rt::usable_cpus());
  /// Waits for the last component to begin; how long after `t0`, in us.
  [[nodiscard]] double last_began(Instant t0) const;
  /// Processor time of a job, in us, seen for so long from now on: all that this process
  /// takes, shared by the jobs.
  [[nodiscard]] double job_takes(Duration time) const;

  std::vector<std::unique_ptr<Component>> components;

 private:
  [[nodiscard]] std::uint64_t jobs() const;
};

/// The cost of one deployment.
struct Deployment {
  double milliseconds = 0;  ///< deploy()
  double last_began = 0;    ///< us after T0
  double resident = 0;      ///< kB a component, more than before the architecture was made
  double kernel_stack = 0;  ///< kB a component
  double job = 0;           ///< us of processor time; where it was run for some time
  double shutdown = 0;      ///< ms
};
/// In a fresh process.
[[nodiscard]] Deployment deploy_many(int count, Duration period = std::chrono::milliseconds(100),
                                     Duration run = Duration{0});

}  // namespace bench
