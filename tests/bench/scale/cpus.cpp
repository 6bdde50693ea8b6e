// SPDX-License-Identifier: LGPL-3.0-or-later
/// The same components on one CPU, on two, up to four where there are so many.
#include <algorithm>
#include <string>
#include <thread>

#include "bench/scale/sweeps.h"
#include "bench/support/checked.h"
#include "bench/support/lateness.h"
#include "bench/support/many.h"
#include "bench/support/sweep.h"

#include <mauve/host/deployer.h>

namespace bench::scale {
namespace {

constexpr int kComponents = 20;
constexpr Duration kPeriod{1'000'000};
constexpr std::size_t kCapacity = 1 << 13;

struct Spread {
  Lateness lateness;
  double job = 0;  // us
};

Spread measure(const std::vector<int>& cpus, Duration time) {
  Many many(kComponents, kPeriod, cpus);
  for (auto& component : many.components) component->core().starts.make_room(kCapacity);
  mauve::Deployer deployer(many);
  must(deployer.deploy());
  Spread spread;
  spread.job = many.job_takes(time);  // before there is a probe, which costs as well
  for (auto& component : many.components) component->core().starts.clear();
  const Probe probe(deployer.t0() + kPeriod.count() / 4);
  std::this_thread::sleep_for(time);
  static_cast<void>(deployer.shutdown());
  for (std::size_t i = 0; i < many.components.size(); ++i) {
    add_lateness(spread.lateness, many.components[i]->core().starts, deployer.t0(), kPeriod,
                 cpus[i % cpus.size()], probe);
  }
  return spread;
}

}  // namespace

void sweep_cpus(Book& book, const Options& options) {
  const std::vector<int> usable = mauve::rt::usable_cpus();
  const std::size_t most = std::min<std::size_t>(4, usable.size());
  const Duration time = std::chrono::milliseconds(options.choose(2000, 200));
  Sweep sweep("cpus", "CPUs for " + std::to_string(kComponents) + " components of 1 kHz", "CPUs",
              {{"begins after its release, p50, us", "us a CPU"},
               {"p99, us", "us a CPU"},
               {"processor time of a job, us", "us a CPU"},
               {"releases missed", "", true},
               {"missed while disturbed", "", true},
               {"jobs set apart", "", true}});
  for (int round = 0; round < options.rounds; ++round) {
    for (std::size_t count = 1; count <= most; ++count) {
      const std::vector<int> cpus(usable.end() - static_cast<std::ptrdiff_t>(count), usable.end());
      const Spread spread = measure(cpus, time);
      sweep.add(static_cast<double>(count),
                {median(spread.lateness.good), percentile(spread.lateness.good, 99), spread.job,
                 static_cast<double>(spread.lateness.missed),
                 static_cast<double>(spread.lateness.missed_apart),
                 static_cast<double>(spread.lateness.apart)});
    }
  }
  sweep.print(book);
  book.text(std::to_string(usable.size()) +
            " CPUs are usable here. Components on one CPU are released at once and begin one after "
            "the other: half of p50 is waiting for the others. Disturbed: a SCHED_FIFO 99 probe "
            "was itself over 200 us late.");
}

}  // namespace bench::scale
