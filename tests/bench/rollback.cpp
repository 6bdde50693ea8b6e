// SPDX-License-Identifier: LGPL-3.0-or-later
/// A core on probation fails: how long until its output has the safe value, and when the old core
/// runs again. Against a raw throw that is caught, and a raw signal handler that jumps back.
#include <array>
#include <atomic>
#include <csetjmp>
#include <csignal>
#include <stdexcept>
#include <string>
#include <thread>

#include "bench/support/checked.h"
#include "bench/support/machine.h"
#include "bench/support/raw.h"
#include "bench/support/report.h"

#include <mauve/detail/job.h>
#include <mauve/host/architecture.h>
#include <mauve/host/deployer.h>

namespace bench {
namespace {

constexpr Duration kPeriod{1'000'000};
constexpr int kPriority = 80;
constexpr double kSafe = -1;
constexpr int kGoodJobs = 2;  // of a core before it fails

/// Of the fault under way. Written in the order of its members.
struct Stamps {
  std::atomic<Instant> fault{0};    ///< just before it
  std::atomic<Instant> release{0};  ///< of the job it happened in
  std::atomic<Instant> safe{0};     ///< the output was given its safe value
  std::atomic<Instant> again{0};    ///< release of the first job of the old core
};
Stamps& stamps() {
  static Stamps one;
  return one;
}

/// The valve that receives the output.
struct Valve : mauve::Core<mauve::EmptyShell> {
  double opening = 0;
  void set(const double& value) {
    opening = value;
    if (value == kSafe) stamps().safe.store(now());
  }
};
struct ValveInterface : mauve::Interface<Valve> {
  mauve::WriteService<double> set{*this, "set", &Valve::set};
};

struct PumpShell : mauve::Shell {
  mauve::WritePort<double> out{*this, "out", mauve::Safe{kSafe}};
};
/// The contract.
struct Pump : mauve::Core<PumpShell> {
  using Contract = Pump;
  static constexpr const char* contract = "pump/core/1";
  mauve::Stateless stateless{*this};
  virtual void update() = 0;
};

struct Sound final : Pump {
  void update() override {
    shell().out.write(1.0);
    if (stamps().fault.load() == 0 || stamps().again.load() != 0) return;
    stamps().again.store(mauve::this_job().release);
  }
};

struct Failing : Pump {
  int jobs = 0;
  void update() final {
    shell().out.write(0.5);
    if (++jobs <= kGoodJobs) return;
    stamps().release.store(mauve::this_job().release);
    stamps().fault.store(now());
    fail();
  }
  virtual void fail() = 0;
};
struct Throwing final : Failing {
  void fail() override { throw std::runtime_error("sensor lost"); }
};
struct Crashing final : Failing {
  int* volatile nobody = nullptr;
  void fail() override { *nobody = 1; }
};

struct Plant : mauve::Architecture {
  explicit Plant(int cpu) {
    pump.fsm().period = kPeriod;
    pump.task().priority = kPriority;
    pump.task().cpus = {cpu};
  }
  mauve::Resource<mauve::EmptyShell, Valve, ValveInterface> valve{*this, "valve"};
  mauve::Component<PumpShell, Sound, mauve::PeriodicFsm<Pump>> pump{*this, "pump"};
  mauve::Status on_configure() override { return pump.shell().out.connect(valve.interface().set); }
};

struct Rollbacks {
  std::vector<double> safe;   // us from the fault until the safe value
  std::vector<double> again;  // periods from the failed job until the first one of the old core
  std::size_t late = 0;       // of these, more than one
  std::size_t apart = 0;      // rollbacks in which the machine was disturbed
};

/// Waits until the change on probation is over, and the old core has run.
void await_end(mauve::Deployer& deployer) {
  constexpr std::chrono::microseconds kPause{200};
  mauve::Retired retired;
  while (deployer.tend(retired).empty()) std::this_thread::sleep_for(kPause);
  while (stamps().again.load() == 0) std::this_thread::sleep_for(kPause);
}

template <typename Core>
Rollbacks roll_back(int count, int cpu) {
  Plant plant(cpu);
  mauve::Deployer deployer(plant);
  must(deployer.deploy());
  const Probe probe(deployer.t0() + kPeriod.count() / 4);
  mauve::Change change;
  change.edits.resize(1);
  change.edits[0].member = "pump";
  change.edits[0].core = mauve::CoreType::of<Core>("failing");
  change.probation = mauve::Probation{.misses = 64};  // no fault but the one that is measured
  Rollbacks result;
  for (int i = 0; i < count; ++i) {
    stamps().fault.store(0);
    stamps().again.store(0);
    static_cast<void>(checked(deployer.apply(change)));
    await_end(deployer);
    deployer.drain([](const mauve::RuntimeEvent&) {});
    std::this_thread::sleep_for(4 * Probe::kPeriod);  // until the probe has reported
    const Instant fault = stamps().fault.load();
    const Instant again = stamps().again.load();
    if (probe.disturbed(cpu, fault) || probe.disturbed(cpu, again)) {
      ++result.apart;
      continue;
    }
    const auto periods = (again - stamps().release.load()) / kPeriod.count();
    result.safe.push_back(static_cast<double>(stamps().safe.load() - fault) / 1e3);
    result.again.push_back(static_cast<double>(periods));
    if (periods != 1) ++result.late;
  }
  static_cast<void>(deployer.shutdown());
  return result;
}

// --- raw ----------------------------------------------------------------------------------------

/// us from a throw until it was caught.
double raw_throw() {
  const Instant begin = now();
  try {
    throw std::runtime_error("sensor lost");
  } catch (const std::exception&) {
    return static_cast<double>(now() - begin) / 1e3;
  }
}

sigjmp_buf& way_out() {
  static sigjmp_buf buffer;
  return buffer;
}

/// us from a crash until the thread is back where it was.
double raw_crash() {
  static std::atomic<Instant> begin{0};
  static int* volatile nobody = nullptr;
  if (sigsetjmp(way_out(), 1) == 0) {
    begin.store(now());
    *nobody = 1;
  }
  return static_cast<double>(now() - begin.load()) / 1e3;
}

/// Of a thread like that of the component, with as much time for others in between.
std::vector<double> raw_times(int count, int cpu, double (*once)()) {
  struct sigaction action {};
  struct sigaction before {};
  action.sa_handler = [](int) { siglongjmp(way_out(), 1); };
  sigaction(SIGSEGV, &action, &before);
  std::vector<double> times;
  std::atomic<bool> enough{false};
  {
    times.reserve(static_cast<std::size_t>(count));
    const RawLoop loop(cpu, fifo_or_none(kPriority), now() + kPeriod.count(), 7 * kPeriod,
                       [&](Instant) {
                         if (enough.load()) return;
                         times.push_back(once());
                         enough.store(times.size() == static_cast<std::size_t>(count));
                       });
    while (!enough.load()) std::this_thread::sleep_for(kPeriod);
  }
  sigaction(SIGSEGV, &before, nullptr);
  return times;
}

struct Lines {
  Lines(Report& report, const std::string& fault)
      : p50(report.figure("safe output after " + fault + ", p50", "us", at_most(20))),
        p99(report.figure("safe output after " + fault + ", p99", "us", at_most(20))),
        again(report.figure("old core runs after " + fault + ", p50", "periods", at_most(1))) {}

  void add(const Rollbacks& ours, const std::vector<double>& raw) {
    p50.add(median(ours.safe), median(raw));
    p99.add(percentile(ours.safe, 99), percentile(raw, 99));
    again.add(median(ours.again));
    all += ours.safe.size();
    late += ours.late;
    apart += ours.apart;
  }
  [[nodiscard]] std::string report_of(const std::string& fault) const {
    return std::to_string(all) + " rollbacks after " + fault + ", " + std::to_string(late) +
           " of them without the old core at the next release; " + std::to_string(apart) +
           " more set apart, around which a SCHED_FIFO 99 probe was itself over 200 us late.";
  }

  Figure& p50;
  Figure& p99;
  Figure& again;
  std::size_t all = 0;
  std::size_t late = 0;
  std::size_t apart = 0;
};

void run(const Options& options) {
  Report report("rollback",
                "A new core of a 1 kHz component on probation fails in its third job: from just "
                "before the throw, or the store to address 0, until the resource behind its output "
                "has the safe value; and how many periods after the failed job the old core runs. "
                "Raw: from a throw until the same function has caught it, and from a crash until a "
                "signal handler has jumped back, as seldom as ours, in a thread of the same CPU "
                "and priority that does nothing else.",
                options);
  Lines throws(report, "a throw");
  Lines crashes(report, "a SIGSEGV");
  const int count = options.choose(100, 10);
  const int cpu = mauve::rt::usable_cpus().back();
  for (int i = 0; i < options.rounds; ++i) {
    throws.add(roll_back<Throwing>(count, cpu), raw_times(count, cpu, raw_throw));
    crashes.add(roll_back<Crashing>(count, cpu), raw_times(count, cpu, raw_crash));
  }
  report.note(throws.report_of("a throw"));
  report.note(crashes.report_of("a SIGSEGV"));
  report.print();
}

}  // namespace
}  // namespace bench

int main(int argc, char** argv) { bench::run(bench::parse(argc, argv)); }
