// SPDX-License-Identifier: LGPL-3.0-or-later
/// The pause of a real-time thread in a swap of its running core, as the receipts report it. The
/// raw thread beside it takes a pointer out of an atomic word when it wakes.
#include <array>
#include <memory>
#include <string>
#include <thread>

#include "bench/support/checked.h"
#include "bench/support/machine.h"
#include "bench/support/raw.h"
#include "bench/support/report.h"
#include "bench/support/stepped_clock.h"
#include "exec/swap/two_phase_commit.h"
#include "exec/task/task.h"

#include <mauve/host/architecture.h>
#include <mauve/host/deployer.h>

namespace bench {
namespace {

constexpr Duration kPeriod{1'000'000};
/// Shorter than the lead of a change: other jobs lie between its decision and its instant.
constexpr Duration kShort{150'000};
constexpr int kPriority = 80;
constexpr int kSwaps = 400;  // a round; 2000 in five

struct Small {
  double value = 0;
};
/// 4 kB, the most that is converted at a boundary, in two layouts.
template <int Revision>
struct Medium {
  double first = 0;
  std::array<double, 511> values{};
};
template <>
struct Medium<2> {
  std::array<double, 511> values{};
  double last = 0;
};
struct Large {
  std::array<double, 8192> values{};  // 64 kB
};

/// The contract.
struct Work : mauve::Core<mauve::EmptyShell> {
  using Contract = Work;
  static constexpr const char* contract = "work/core/1";
  virtual void update() = 0;
};
template <int Version>
struct Without final : Work {
  mauve::Stateless stateless{*this};
  int jobs = 0;
  void update() override { ++jobs; }
};
template <int Version, typename T>
struct With final : Work {
  mauve::State<T> state{*this};
  void update() override { *reinterpret_cast<double*>(&*state) += Version; }
};

template <int Version, int Other>
struct Converting final : Work {
  mauve::State<Medium<Version>> state{*this};
  mauve::Converts<Medium<Other>, Medium<Version>> from{
      state,
      [](const Medium<Other>& old, Medium<Version>& now) noexcept { now.values = old.values; }};
  void update() override { state->values[0] += Version; }
};

template <typename First>
struct OneComponent : mauve::Architecture {
  explicit OneComponent(int cpu, Duration period = kPeriod) {
    component.fsm().period = period;
    component.task().priority = kPriority;
    component.task().cpus = {cpu};
  }
  mauve::Component<mauve::EmptyShell, First, mauve::PeriodicFsm<Work>> component{*this, "work"};
};

struct Swaps {
  std::vector<double> pauses;  // ns
  std::uint64_t missed = 0;    // releases, as the receipts say
  std::uint64_t apart = 0;     // of those, with a disturbance of the machine

  /// Adds the others to these; their pauses.
  std::vector<double> count(const Swaps& others) {
    pauses.insert(pauses.end(), others.pauses.begin(), others.pauses.end());
    missed += others.missed;
    apart += others.apart;
    return others.pauses;
  }
};

/// Swaps to and fro; each waits until the one before is in force.
template <typename A, typename B>
Swaps swap_to_and_fro(Places places, int swaps, Duration period = kPeriod) {
  OneComponent<A> architecture(places.component, period);
  mauve::Deployer deployer(architecture);
  must(deployer.deploy());
  const Probe probe(deployer.t0() + kPeriod.count() / 4);
  const OnCpu here(places.coordinator, 0);
  Swaps result;
  for (int i = 0; i < swaps; ++i) {
    const std::size_t windows = probe.windows();
    const mauve::Receipt receipt =
        checked(i % 2 == 0 ? deployer.swap_core<B>("work") : deployer.swap_core<A>("work"));
    result.pauses.push_back(static_cast<double>(receipt.components[0].pause.count()));
    result.missed += receipt.components[0].missed;
    if (receipt.components[0].missed == 0) continue;
    std::this_thread::sleep_for(10 * Probe::kPeriod);  // until the probe has reported
    if (probe.windows() != windows) result.apart += receipt.components[0].missed;
  }
  static_cast<void>(deployer.shutdown());
  return result;
}

/// A task driven by hand: what a job with a swap takes longer than one without, all of it: slot,
/// decision, bundle, hand-over, event, answer. Caches are warm here. ns.
double added_to_a_job(int cpu, int swaps) {
  OneComponent<With<1, Small>> first(cpu);
  OneComponent<With<2, Small>> second(cpu);
  must(first.configure());
  must(second.configure());
  const std::array<mauve::ComponentBase*, 2> bundles{&second.component, &first.component};
  SteppedClock clock;
  mauve::exec::Task task("work", clock);
  const auto make = [](mauve::ComponentBase& of) {
    auto made = std::make_unique<mauve::exec::TaskUpdate>();
    made->bundle = of.bundle();
    return made;
  };
  task.begin(make(first.component), clock.now());
  const auto job = [&] {
    clock.set(task.next_release());
    const Instant start = now();
    task.run_release();
    return static_cast<double>(now() - start);
  };
  std::vector<double> added;
  std::vector<double> plain;
  for (int i = 0; i < swaps; ++i) {
    const OnCpu here(cpu, fifo_or_none(kPriority));
    mauve::ComponentBase& next = *bundles[static_cast<std::size_t>(i) % 2];
    mauve::ComponentBase& old = *bundles[static_cast<std::size_t>(i + 1) % 2];
    mauve::exec::Decision transaction(task.next_release());
    transaction.decide(mauve::exec::Decision::State::committed);
    auto update = make(next);
    update->decision = &transaction;
    update->hand_over =
        checked(mauve::plan_hand_over(old.core(), next.core(), mauve::StatePolicy::keep));
    task.mailbox().publish(*update.release());
    added.push_back(job());
    static_cast<void>(task.mailbox().reclaim());
    plain.push_back(job());
  }
  must_hold(task.counters().releases == 2 * static_cast<std::uint64_t>(swaps),
            "some releases were no jobs");
  return median(added) - median(plain);
}

struct Line {
  Figure& p50;
  Figure& p99;
  void add(const std::vector<double>& ours, const std::vector<double>& raw) {
    p50.add(median(ours), median(raw));
    p99.add(percentile(ours, 99), percentile(raw, 99));
  }
};

Line line(Report& report, const std::string& name, double p50, double p99) {
  Figure& middle = report.figure(name + ", p50", "ns", at_most(p50));
  return {middle, report.figure(name + ", p99", "ns", at_most(p99))};
}

void run(const Options& options) {
  Report report("swap",
                "Pause of the real-time thread of a 1 kHz component in which its core is swapped, "
                "as the receipts say, against a raw exchange of a pointer between two readings of "
                "the clock. The coordinator is on another CPU unless said otherwise.",
                options);
  const int first = mauve::rt::usable_cpus().front();
  const int last = mauve::rt::usable_cpus().back();
  Line same = line(report, "no state, coordinator on the same CPU", 100, 500);
  Line without = line(report, "no state", 100, 500);
  Line small = line(report, "8 B of state handed over", 300, 500);
  Line large = line(report, "64 kB of state handed over", 300, 500);
  Line converted = line(report, "4 kB of state converted to another layout", 300, 500);
  Line brief = line(report, "no state, period 150 us", 100, 500);
  Figure& added = report.figure("a job with a swap takes longer by, warm", "ns", at_most(300));
  const int swaps = options.choose(kSwaps, 50);
  Swaps all;
  for (int i = 0; i < options.rounds; ++i) {
    const Places apart{last, first};
    const Places together{last, last};
    using A = Without<1>;
    using B = Without<2>;
    same.add(all.count(swap_to_and_fro<A, B>(together, swaps)),
             raw_exchanges(together, kPriority, swaps));
    const auto raw = raw_exchanges(apart, kPriority, swaps);
    without.add(all.count(swap_to_and_fro<A, B>(apart, swaps)), raw);
    small.add(all.count(swap_to_and_fro<With<1, Small>, With<2, Small>>(apart, swaps)), raw);
    large.add(all.count(swap_to_and_fro<With<1, Large>, With<2, Large>>(apart, swaps)), raw);
    converted.add(all.count(swap_to_and_fro<Converting<1, 2>, Converting<2, 1>>(apart, swaps)),
                  raw);
    brief.add(all.count(swap_to_and_fro<A, B>(apart, swaps, kShort)), raw);
    added.add(added_to_a_job(last, 10 * swaps));
  }
  report.note(std::to_string(all.pauses.size()) + " swaps; releases missed by them: " +
              std::to_string(all.missed - all.apart) + " (" + std::to_string(all.apart) +
              " more while a SCHED_FIFO 99 probe was itself over 200 us late).");
  report.print();
}

}  // namespace
}  // namespace bench

int main(int argc, char** argv) { bench::run(bench::parse(argc, argv)); }
