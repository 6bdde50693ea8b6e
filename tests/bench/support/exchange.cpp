// SPDX-License-Identifier: LGPL-3.0-or-later
#include "bench/support/exchange.h"

#include <algorithm>
#include <atomic>
#include <cstdint>

#include "bench/support/report.h"
#include "rt/thread/thread.h"

namespace bench {
namespace {

constexpr int kPriority = 50;
constexpr int kMostAgain = 50;  // batches for each that counts

/// Additions that keep a core busy. Where another machine runs on its second thread, they take
/// longer, and so does everything else, each in another way.
double time_of_additions() {
  std::array<std::uint64_t, 4> sums{};
  const Instant start = now();
  for (std::uint64_t i = 0; i < 2000; ++i) {
    for (std::uint64_t& sum : sums) {
      sum += i;
      asm volatile("" : "+r"(sum));
    }
  }
  return static_cast<double>(now() - start);
}

bool have_the_core() {
  static double quickest = time_of_additions();
  const double time = time_of_additions();
  quickest = std::min(quickest, time);
  return time < 1.2 * quickest;
}

}  // namespace

std::vector<double> alone(const std::vector<Operation>& operations, int times, int batches) {
  std::vector<std::vector<double>> results(operations.size());
  const int priority = fifo_or_none(kPriority);
  int again = kMostAgain * batches;
  for (int batch = 0; batch < batches;) {
    const OnCpu here(mauve::rt::usable_cpus().back(), priority);
    std::vector<double> row;
    bool whole = have_the_core();
    for (const Operation& operation : operations) {
      operation(times / 10);  // warm, the first one too: this thread may come from another CPU
      const Instant start = now();
      operation(times);
      row.push_back(static_cast<double>(now() - start) / times);
    }
    whole = have_the_core() && whole;
    if (!whole && again-- > 0) continue;
    for (std::size_t i = 0; i < row.size(); ++i) results[i].push_back(row[i]);
    ++batch;
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
