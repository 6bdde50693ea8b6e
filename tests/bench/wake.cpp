// SPDX-License-Identifier: LGPL-3.0-or-later
/// The lateness of a 1 kHz component at the start of its job. A raw thread of the same priority
/// runs on the same CPU, with releases half a period off, so both live through the same
/// milliseconds.
#include <string>
#include <thread>

#include "bench/support/checked.h"
#include "bench/support/lateness.h"
#include "bench/support/machine.h"
#include "bench/support/raw.h"
#include "bench/support/report.h"

#include <mauve/host/architecture.h>
#include <mauve/host/deployer.h>

namespace bench {
namespace {

constexpr Duration kPeriod{1'000'000};
constexpr int kPriority = 80;
constexpr std::size_t kCapacity = 1 << 16;

Instants& started() {
  static Instants instants(kCapacity);
  return instants;
}

struct Noting : mauve::Core<mauve::EmptyShell> {
  mauve::Stateless stateless{*this};
  void update() { started().add(now()); }
};

struct OneComponent : mauve::Architecture {
  explicit OneComponent(int cpu) {
    component.fsm().period = kPeriod;
    component.task().priority = kPriority;
    component.task().cpus = {cpu};
  }
  mauve::Component<mauve::EmptyShell, Noting, mauve::PeriodicFsm<Noting>> component{*this,
                                                                                    "noting"};
};

struct Round {
  Lateness ours;
  Lateness raw;
  std::size_t windows = 0;
};

Round measure(int cpu, Duration time) {
  started().clear();
  Instants raw_started(kCapacity);
  OneComponent architecture(cpu);
  mauve::Deployer deployer(architecture);
  must(deployer.deploy());
  const Instant t0 = deployer.t0();
  const Instant raw_first = t0 + kPeriod.count() / 2 + 20 * kPeriod.count();
  const Probe probe(t0 + kPeriod.count() / 4);
  {
    const RawLoop raw(cpu, fifo_or_none(kPriority), raw_first, kPeriod,
                      [&](Instant woke) { raw_started.add(woke); });
    std::this_thread::sleep_for(time);
  }
  Round round;
  static_cast<void>(deployer.shutdown());
  add_lateness(round.ours, started(), t0, kPeriod, cpu, probe);
  add_lateness(round.raw, raw_started, raw_first, kPeriod, cpu, probe);
  round.windows = probe.windows();
  return round;
}

void run(const Options& options) {
  Report report("wake",
                "Start of a job of a 1 kHz component after its release, against a raw futex loop "
                "with absolute times, same CPU and priority, half a period off.",
                options);
  Figure& p50 = report.figure("wake-up, p50", "us", above_raw(1));
  Figure& p99 = report.figure("wake-up, p99", "us", above_raw(10));
  std::size_t samples = 0;
  std::size_t apart = 0;
  std::size_t windows = 0;
  std::int64_t missed = 0;
  std::int64_t missed_apart = 0;
  const int cpu = mauve::rt::usable_cpus().back();
  for (int i = 0; i < options.rounds; ++i) {
    const Round round = measure(cpu, std::chrono::milliseconds(options.choose(3000, 500)));
    p50.add(median(round.ours.good), median(round.raw.good));
    p99.add(percentile(round.ours.good, 99), percentile(round.raw.good, 99));
    samples += round.ours.good.size();
    apart += round.ours.apart;
    windows += round.windows;
    missed += round.ours.missed;
    missed_apart += round.ours.missed_apart;
  }
  report.note(std::to_string(samples) + " jobs, " + std::to_string(missed) +
              " releases missed; apart: " + std::to_string(apart) + " jobs and " +
              std::to_string(missed_apart) + " missed releases, in " + std::to_string(windows) +
              " windows in which a SCHED_FIFO 99 probe was itself over 200 us late.");
  report.print();
}

}  // namespace
}  // namespace bench

int main(int argc, char** argv) { bench::run(bench::parse(argc, argv)); }
