// SPDX-License-Identifier: LGPL-3.0-or-later
#include "bench/support/exchange.h"

#include <atomic>

#include "bench/support/report.h"
#include "rt/thread.h"

namespace bench {
namespace {

constexpr int kPriority = 50;

}  // namespace

std::vector<double> alone(const std::vector<Operation>& operations, int times, int batches) {
  std::vector<std::vector<double>> results(operations.size());
  const int priority = fifo_or_none(kPriority);
  for (int batch = 0; batch < batches; ++batch) {
    const OnCpu here(mauve::rt::usable_cpus().back(), priority);
    for (std::size_t i = 0; i < operations.size(); ++i) {
      const Instant start = now();
      operations[i](times);
      results[i].push_back(static_cast<double>(now() - start) / times);
    }
  }
  std::vector<double> medians;
  for (auto& result : results) medians.push_back(median(result));
  return medians;
}

std::array<double, 2> together(const Operation& first, const Operation& second, int times) {
  const std::array<const Operation*, 2> operations{&first, &second};
  const std::vector<int> cpus = mauve::rt::usable_cpus();
  const int priority = fifo_or_none(kPriority);
  std::atomic<int> ready{0};
  std::atomic<bool> over{false};
  std::array<std::vector<double>, 2> results;
  std::array<mauve::rt::Thread, 2> threads;
  for (std::size_t i = 0; i < 2; ++i) {
    const auto body = [&, i] {
      for (ready.fetch_add(1); ready.load() < 2;) {
      }
      const Instant start = now();
      for (Instant before = start; !over.load(std::memory_order_relaxed);) {
        (*operations[i])(times);
        const Instant after = now();
        results[i].push_back(static_cast<double>(after - before) / times);
        before = after;
        if (after - start > 10'000'000) over.store(true, std::memory_order_relaxed);
      }
    };
    static_cast<void>(threads[i].start({"bench-data", priority, {cpus[i]}}, body));
  }
  for (auto& thread : threads) thread.join();
  return {median(results[0]), median(results[1])};
}

}  // namespace bench
