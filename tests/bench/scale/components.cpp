// SPDX-License-Identifier: LGPL-3.0-or-later
/// 2 to 500 components of 100 Hz, each deployment in a fresh process.
#include "bench/scale/sweeps.h"
#include "bench/support/fresh.h"
#include "bench/support/many.h"
#include "bench/support/sweep.h"

namespace bench::scale {
namespace {

constexpr int kJobsASecond = 100;

}  // namespace

void sweep_components(Book& book, const Options& options) {
  const std::vector<int> counts =
      options.smoke ? std::vector<int>{2, 10} : std::vector<int>{2, 10, 50, 100, 200, 500};
  const Duration run = std::chrono::milliseconds(options.choose(1000, 100));
  Sweep sweep("components", "Components of 100 Hz, over all CPUs", "components",
              {{"deploy(), ms", "ms a component"},
               {"T0 until the last runs, us", "us a component"},
               {"shutdown(), ms", "ms a component"},
               {"resident memory of all, kB", "kB a component"},
               {"kernel stacks of all, kB", "kB a component"},
               {"busy, ms a second", "ms a component"},
               {"of a job, us", "us a component"}});
  for (int round = 0; round < options.rounds; ++round) {
    for (const int count : counts) {
      const auto cost = in_child<Deployment>(
          [&] { return deploy_many(count, Duration{1'000'000'000 / kJobsASecond}, run); });
      sweep.add(count,
                {cost.milliseconds, cost.last_began, cost.shutdown, cost.resident * count,
                 cost.kernel_stack * count, cost.job * count * kJobsASecond / 1e3, cost.job});
    }
  }
  sweep.print(book);
  book.text(
      "All are released at the same instants. Busy is the process: jobs, the kernel's wake-ups, "
      "and "
      "the runtime's own threads, which are most of it at two components; its slope divided by 100 "
      "is what one more job costs.");
}

}  // namespace bench::scale
