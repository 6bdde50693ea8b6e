// SPDX-License-Identifier: LGPL-3.0-or-later
/// For claims about time: load that disturbs, and a probe that reports when the machine itself
/// stood still, so that such windows are set apart.
#pragma once

#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

#include "rt/thread/futex.h"
#include "rt/thread/thread.h"

#include <mauve/host/clock.h>

namespace mauve::test {

/// A SCHED_FIFO 99 thread per CPU that notes when it was woken late itself.
class Probe {
 public:
  static constexpr Instant kPeriod = 250'000;
  static constexpr Instant kLate = 200'000;

  explicit Probe(int cpu) {
    started_ = thread_.start({"probe", 99, {cpu}, 64 * 1024}, [this] { run(); }).has_value();
  }
  ~Probe() {
    quit_ = true;
    thread_.join();
  }
  [[nodiscard]] bool started() const { return started_; }
  [[nodiscard]] std::uint64_t disturbances() const { return disturbances_; }
  [[nodiscard]] Instant worst() const { return worst_; }

 private:
  void run() {
    const mauve::MonotonicClock clock;
    const std::atomic<std::uint32_t> never{0};
    for (Instant next = clock.now() + kPeriod; !quit_; next += kPeriod) {
      while (clock.now() < next) rt::futex_wait_until(never, 0, next);
      const Instant late = clock.now() - next;
      if (late > worst_) worst_ = late;
      if (late <= kLate) continue;
      ++disturbances_;
      next += late / kPeriod * kPeriod;
    }
  }

  std::atomic<bool> quit_{false};
  std::atomic<std::uint64_t> disturbances_{0};
  std::atomic<Instant> worst_{0};
  bool started_ = false;
  rt::Thread thread_;
};

/// Ordinary threads that want every CPU all the time.
class Load {
 public:
  Load() {
    for (std::size_t i = 0; i < 2 * rt::usable_cpus().size(); ++i) {
      threads_.emplace_back([this] {
        volatile double x = 1;
        while (!quit_) x = x * 1.0000001 + 1e-9;
      });
    }
  }
  ~Load() {
    quit_ = true;
    for (std::thread& thread : threads_) thread.join();
  }

 private:
  std::atomic<bool> quit_{false};
  std::vector<std::thread> threads_;
};

}  // namespace mauve::test
